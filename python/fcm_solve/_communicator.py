"""Communicators of mpi4py, in the form that the compiled part takes."""


def handle(comm):
    """The handle of an mpi4py communicator and the name of its MPI library; None without a communicator."""
    if comm is None:
        return None
    try:
        from mpi4py import MPI
    except ImportError as error:
        raise ImportError("comm is a communicator of mpi4py, which is not installed: pip install mpi4py") from error
    return comm.py2f(), MPI.Get_library_version()
