"""What both wings share: which states meet at a face, and which impulse friction gives a cell."""
