"""Observers: what is noted down while a run goes on, between blocks of steps."""
