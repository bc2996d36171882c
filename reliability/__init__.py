"""What pliant withstands: programs that run once, go on where they were cut off, and report figures."""
