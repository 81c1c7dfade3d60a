"""Files of others: tables in text files, and the process that reads what may be damaged."""
