"""The exceptions of the module. The message of each names the stream and the offending values."""


class Error(Exception):
    """Base of all exceptions of this module."""


class NoSuchStream(Error):
    """There is no stream of this name, it did not appear before the timeout, or it was removed."""


class StreamBusy(Error):
    """Another living process owns the region to be written or removed."""


class BadRegion(Error):
    """A region that must not be used: another layout, a wrong size, an untrusted owner or mode."""


class OutOfResources(BadRegion):
    """No memory, shared memory or file descriptor is left: a later retry may succeed."""


class BadRequest(Error, ValueError):
    """A value is out of range, or options contradict the existing stream."""


class Refused(Error):
    """The ring did not accept an item; nothing has changed.

    Attributes
    ----------
    status : AppendStatus
        Why.
    time : int or None
        The time of the item [ns]; None for an item without one, such as the end of the stream.
    position : numpy.ndarray or None
        The position of the waypoint, shape (D,); None for an item without one.
    index : int or None
        For `Producer.append_many`: the number of waypoints that were accepted before this one.
    """

    status = None
    time = None
    position = None
    index = None


class Full(Refused):
    """The ring has no room until the solver consumes items. Retry, or give a timeout."""
