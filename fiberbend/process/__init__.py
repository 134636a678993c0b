"""This process among others: its rank, its signals, its output, the folder that it holds."""
