"""The kinetic wing: the density f(x, xi) on a velocity grid; rows are cells, columns are velocities."""
