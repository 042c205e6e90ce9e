"""The kinetic formulation on smooth chutes, section 2.2: the equilibrium, (17) and its better relatives, their maps."""
