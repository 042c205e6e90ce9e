"""The schemes: which states meet at a face, which flux a cell takes there, and which impulse friction gives it."""
