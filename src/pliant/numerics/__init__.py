"""Arrays in, arrays out: the mathematics that several rooms share."""
