"""The macroscopic wing: the same step with closed-form half-range moments."""
