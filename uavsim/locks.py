"""Locks that the system takes away when their process ends, however it ends.

A file is locked, not made: what a killed process leaves is a file that nobody holds.
"""

import os
import sys

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl


def lock(file: int) -> bool:
    """Lock an open file for this process alone, until it is closed.

    Parameters
    ----------
    file
        Descriptor, open for writing.

    Returns
    -------
    bool
        False if another one holds it.

    Raises
    ------
    OSError
        The file system has no locks (some that come over a network).
    """
    try:
        if sys.platform == "win32":
            os.lseek(file, 0, os.SEEK_SET)
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
        else:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):  # so says POSIX, so says Windows
        return False
    return True
