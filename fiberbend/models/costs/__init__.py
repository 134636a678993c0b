"""Processor time and memory of runs of finite elements."""
