"""What a mutant may take."""

MEMORY = 1 << 30  # bytes, beside what the process that reads it has
SECONDS = 10  # of the processor: what a busy machine makes of them does not count
