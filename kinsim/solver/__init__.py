"""A scene and a method made ready to step: work arrays, the march of many steps, and one step with all its stages."""
