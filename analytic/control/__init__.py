"""The feedback loop of the paper's section VI."""
