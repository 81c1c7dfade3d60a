"""How values are refused or doubted, and how that is reported."""
