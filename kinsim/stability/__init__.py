"""Stability at the extremes: what a method does where numbers, slopes and steps become as large or small as can be."""
