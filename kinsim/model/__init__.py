"""What the paper assumes: cells, chute, friction, heap, boundary."""
