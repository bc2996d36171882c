"""A format of landmarks is one file: from bytes, and to bytes with what is lost."""
