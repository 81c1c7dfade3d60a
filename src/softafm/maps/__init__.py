"""Maps: images of samples that vary from place to place."""
