"""Films of a run: the density over (x, xi) beside height and velocity, as GIF, HTML page or mp4."""
