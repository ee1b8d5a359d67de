"""The command line: a face on the public functions; nothing is computed here."""
