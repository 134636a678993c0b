"""report.html: one page of a run or a sweep that opens without a network."""
