"""How kernels run: compiled once, eight lanes wide, driven over chunks by threads."""
