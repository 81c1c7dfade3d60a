"""The page: a form, runs in processes of their own, and results that one can look into."""
