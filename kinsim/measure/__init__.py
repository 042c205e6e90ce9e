"""What runs tell about each other."""
