"""The instrument: levers, and how the tip or its base moves."""
