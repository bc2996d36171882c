"""The command line: one module a command, no mathematics. Nothing heavy is imported before a command runs."""
