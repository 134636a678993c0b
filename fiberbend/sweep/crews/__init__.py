"""Who solves the points of a sweep: this process, a pool of processes, the ranks of a launch."""
