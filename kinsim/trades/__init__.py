"""Speed against accuracy, measured on a scene: a family of methods, their costs and errors, and what to choose."""
