"""What several ranks on one machine need, as root and beside other programs."""

from __future__ import annotations

MPIRUN = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",  # of Open MPI 5
    # Open MPI 5.0.7 complains where a machine has IPv4 and IPv6
    "OMPI_MCA_btl_tcp_disable_family": "6",
    # containers forbid the single copy of shared memory, and Open MPI then complains
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
}
"""Variables of the environment of mpirun."""
