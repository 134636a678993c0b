"""Tests of sections as beams."""
