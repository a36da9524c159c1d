"""Compute on a Dask cluster: within a block, joblib sends its calls to the cluster's workers."""

from collections.abc import Iterator
from contextlib import contextmanager

from hnr_planner.core.errors import HnrError
from joblib import effective_n_jobs, parallel_config


class ClusterError(HnrError, ValueError):
    """Error: no scheduler answers at the address of a cluster, or it has no workers."""


@contextmanager
def on_cluster(address: str) -> Iterator[None]:
    """
    Let joblib compute on a Dask cluster within a block, in all threads of all its workers.

    What is still being computed at the end of the block is cancelled.

    Parameters
    ----------
    address : str
        Address of the scheduler, such as ``tcp://10.0.0.5:8786``.

    Raises
    ------
    ClusterError
        When no scheduler answers at the address within Dask's own time limit
        (``distributed.comm.timeouts.connect``), or no worker has joined it after 10 s.

    """
    from distributed import Client

    try:
        client = Client(address)
    except (OSError, ValueError) as error:
        raise ClusterError(f'no Dask scheduler answers at {address}: {error}') from error
    with client, parallel_config(backend='dask', client=client):
        try:
            effective_n_jobs()  # waits for workers, and asks an adaptive cluster to start them
        except TimeoutError as error:
            raise ClusterError(f'the Dask scheduler at {address} has no workers') from error
        yield
