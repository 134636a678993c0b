"""The computer that a run finds: which of its folders can be used and trusted."""
