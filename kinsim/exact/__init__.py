"""Exact solutions to judge the schemes by; each is tested by its own residual."""

from .riemann import Riemann

__all__ = ["Riemann"]
