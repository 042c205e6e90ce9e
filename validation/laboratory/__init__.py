"""What the chapters about the kinetic wing share: the variants, how they are measured, how they are drawn."""
