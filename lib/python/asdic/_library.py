"""What the package makes of the C library: errors, contexts, ownership, arrays and structs.

The other modules build on these five and on asdic._native, which is compiled from the public headers: no
struct, constant or enum of the library is written down here a second time.
"""
from __future__ import annotations

import atexit
import functools
import logging
import math
import os
import re
import signal
import sys
import threading
import warnings
import weakref
from types import SimpleNamespace
from typing import Any, Callable, Optional

import numpy as np
from numpy.typing import ArrayLike

from ._native import ffi, lib

LOGGER = logging.getLogger("asdic")

# ---- errors ----------------------------------------------------------------------------------


class Error(Exception):
    """The library's sentence: what failed, with which value, against which limit, and what to do."""

    status: int = 0
    """The asdic_status of the call."""
    messages: tuple[str, ...] = ()
    """Every error of an input that has several, with file, line and key."""


class ArgumentError(Error, ValueError):
    """A value outside the documented domain."""


class InputError(Error, ValueError):
    """An input is missing, malformed or out of range."""


class DeviceError(Error, RuntimeError):
    """No usable OpenCL device, or its compiler refused the kernels."""


class DeviceLostError(DeviceError):
    """A device failed while working."""


class MemoryShortError(Error, MemoryError):
    """The memory of host or device is exhausted, or is known to be too small."""


class FileError(Error, OSError):
    """Writing or reading failed half-way."""


class ExistsError(Error, FileExistsError):
    """Output exists, and neither force nor resume was asked for."""


class StoppedError(Error):
    """Stopped on request; what was written is valid."""


class UnsupportedError(Error, NotImplementedError):
    """What was asked for needs a library that this build, or this machine, lacks."""


class ClosedError(Error, ValueError):
    """Used after close(), or in a process that was forked since."""


class Remark(UserWarning):
    """A law outside its stated range, too few rays: levels are computed all the same."""


ERRORS: dict[int, type[Error]] = {
    lib.ASDIC_ERROR_ARGUMENT: ArgumentError,
    lib.ASDIC_ERROR_INPUT: InputError,
    lib.ASDIC_ERROR_DEVICE: DeviceError,
    lib.ASDIC_ERROR_DEVICE_LOST: DeviceLostError,
    lib.ASDIC_ERROR_MEMORY: MemoryShortError,
    lib.ASDIC_ERROR_IO: FileError,
    lib.ASDIC_ERROR_EXISTS: ExistsError,
    lib.ASDIC_ERROR_INTERRUPTED: StoppedError,
    lib.ASDIC_ERROR_UNSUPPORTED: UnsupportedError,
}


def fail(kind: type[Error], sentence: str) -> Error:
    """An error that this package finds before the library could."""
    error = kind(sentence)
    error.status = next((status for status, known in ERRORS.items() if known is kind), 0)
    return error


# ---- ownership -------------------------------------------------------------------------------


class _Process:  # pylint: disable=too-few-public-methods
    """Which one this is; known without a call of the system, which every ping would make."""

    number = os.getpid()

    @classmethod
    def forked(cls) -> None:
        cls.number = os.getpid()


os.register_at_fork(after_in_child=_Process.forked)


def _destroy(place: Any, destroy: Callable[..., None], process: int, _keeps: tuple[Any, ...]) -> None:
    if process == _Process.number:  # a forked process has no threads that devices could work with
        destroy(place)


class Handle:
    """What the library created: `place` points to the pointer, `destroy` takes it.

    It is destroyed when nobody needs it, and what it KEEPS after it: finalizers are global, so that the
    order is the same for garbage in circles and at exit.
    """

    __slots__ = ("_place", "_process", "_finalizer", "_name", "__weakref__")

    def __init__(self, name: str, place: Any, destroy: Callable[..., None], *keeps: Any) -> None:
        self._place, self._name, self._process = place, name, _Process.number
        self._finalizer = weakref.finalize(self, _destroy, place, destroy, self._process, keeps)

    @property
    def pointer(self) -> Any:
        pointer = self._place[0]
        if not pointer:
            raise fail(ClosedError, f"the {self._name} is closed")
        if self._process != _Process.number:
            raise fail(ClosedError, f"the {self._name} is of the process that forked this one; make it anew here, "
                       "or start processes by multiprocessing's 'spawn'")
        return pointer

    def __reduce__(self) -> Any:
        raise TypeError(f"the {self._name} is of this process and cannot be copied or pickled; other processes take scenes, "
                        "folders and arrays")

    def close(self) -> None:
        self._finalizer()

    def outlive(self) -> None:
        """Not destroyed at the interpreter's end: what runs later may still look at it."""
        self._finalizer.atexit = False


# ---- contexts --------------------------------------------------------------------------------


@ffi.def_extern()
def asdic_python_log(user: Any, level: int, message: Any) -> None:
    ffi.from_handle(user).append((level, text(message)))


@ffi.def_extern()
def asdic_python_progress(user: Any, what: Any, done: int, total: int) -> None:
    ffi.from_handle(user)[:] = [(text(what), done, total)]


@ffi.def_extern()
def asdic_python_run_progress(user: Any, progress: Any) -> None:
    ffi.from_handle(user)[:] = [("pings", progress.pings_done, progress.pings_total)]


Progress = Optional[Callable[[str, int, int], Any]]


def bar(what: str, done: int, total: int) -> None:
    """A line that grows, on a terminal and below a notebook's cell."""
    filled = 30 * done // max(total, 1)
    print(f"\r[{'#' * filled}{'.' * (30 - filled)}] {done} of {total} {what}",
          end="\n" if done >= total else "", flush=True)


PACKAGE = os.path.dirname(__file__) + os.sep


def warn(message: str) -> None:
    """A Remark at the line of the caller that is not of this package."""
    depth, frame = 2, sys._getframe(1)  # pylint: disable=protected-access
    while frame.f_back and frame.f_code.co_filename.startswith(PACKAGE):
        depth, frame = depth + 1, frame.f_back
    warnings.warn(message, Remark, stacklevel=depth)


_SIGNALS = sorted(signal.valid_signals())


def _set_handler(number: int, handler: Any) -> None:
    """Python's alone: what C code or siginterrupt has made of the signal stays."""
    action = ffi.new("struct sigaction *")
    lib.sigaction(number, ffi.NULL, action)
    signal.signal(number, handler)
    lib.sigaction(number, action, ffi.NULL)


class _Call:
    """A call of the library in a thread, so that this one hears of signals and reports progress.

    Left on its own it would work on memory that is freed. So what is raised here meanwhile, by handlers of signals, by
    what reports, by another thread (PyThreadState_SetAsyncExc), interrupts it, and is raised again when it is over.
    What reports may take long, and is left at once.
    """

    def __init__(self, function: Callable[..., int], args: tuple[Any, ...], interrupt: Callable[[], Any]) -> None:
        self._function, self._args, self._interrupt = function, args, interrupt
        self._turn, self._end, self._is_over = threading.Lock(), threading.Lock(), False
        self._handlers: dict[int, Any] = {}
        self._raised: BaseException | None = None
        self._is_reporting, self._is_told, self._status = False, False, 0
        self._end.acquire()  # pylint: disable=consider-using-with # the call releases it

    def _work(self) -> None:
        if not self._turn.acquire(blocking=False):
            return
        try:
            self._status = self._function(*self._args)
        except BaseException as error:  # pylint: disable=broad-except # an argument of a wrong type
            self._raised = self._raised or error
        finally:
            self._is_over = True
            self._end.release()

    def _note(self, number: int, frame: Any) -> None:
        try:
            self._handlers[number](number, frame)
        except BaseException as error:  # pylint: disable=broad-except
            if self._is_reporting or self._is_told:
                raise
            self._raised = self._raised or error

    def _begin(self) -> None:
        if threading.current_thread() is threading.main_thread():
            for number in _SIGNALS:
                handler = signal.getsignal(number)
                if callable(handler):
                    self._handlers[number] = handler
                    _set_handler(number, self._note)
        threading.Thread(target=self._work, name="asdic").start()

    def _attend(self, report: Callable[[], None]) -> None:
        if self._raised is None:
            self._begin()
        while not self._is_over:
            if self._raised is None:
                if not self._end.acquire(timeout=0.1):
                    self._is_reporting = True
                    report()
                    self._is_reporting = False
            elif self._turn.acquire(blocking=False):
                self._is_over = True  # it has not begun, and never will
            else:
                self._interrupt()
                self._end.acquire()
        for number, handler in self._handlers.items():
            if signal.getsignal(number) == self._note:
                _set_handler(number, handler)
        self._is_told = True

    def result(self, report: Callable[[], None]) -> int:
        """Its status, once it is over; REPORT is called now and then."""
        while not self._is_told:
            try:
                self._attend(report)
            except BaseException as error:  # pylint: disable=broad-except # no call in here, which could raise another
                self._is_reporting = False
                self._raised = self._raised or error
        raised, self._raised = self._raised, None
        try:
            if raised is not None:
                raise raised
        finally:
            del raised  # a circle: its traceback has this frame
        return self._status


_OPTION = re.compile(r"(?<!'asdic run' with )--(force|resume)\b")
"""What the library calls by the program's options; here they are arguments."""


class Context:
    """One context of the library, for one thread at a time: others wait."""

    is_quiet = False
    """Whether warnings go to the logger too."""

    def __init__(self, progress: Progress | bool = None) -> None:
        place = ffi.new("asdic_context **")
        self._log: list[tuple[int, str]] = []
        self._done: list[tuple[str, int, int]] = []
        self._log_handle, self.progress_user = ffi.new_handle(self._log), ffi.new_handle(self._done)
        self._progress = bar if progress is True else progress or None
        self._last: tuple[str, int, int] | None = None
        self.lock, self.process = threading.RLock(), _Process.number
        if lib.asdic_context_create(place):
            raise fail(MemoryShortError, "out of memory while allocating a context")
        self.handle = Handle("context", place, lib.asdic_context_destroy, self._log_handle, self.progress_user)
        lib.asdic_context_set_log(place[0], lib.ASDIC_LOG_NOTE, lib.asdic_python_log, self._log_handle)
        _CONTEXTS.add(self)
        lib.asdic_context_set_progress(place[0], lib.asdic_python_progress, self.progress_user)

    def __reduce__(self) -> Any:
        return self.handle.__reduce__()

    @property
    def pointer(self) -> Any:
        return self.handle.pointer

    def check(self, status: int) -> None:
        """Raises what STATUS says; passes the library's warnings and notes on."""
        if self._log or status:
            self._tell(status)

    def _tell(self, status: int) -> None:
        said, self._log[:] = list(self._log), []
        for level, message in said:
            survived = level == lib.ASDIC_LOG_ERROR and not status
            if survived or level == lib.ASDIC_LOG_WARNING and not self.is_quiet:
                warn(message)
            elif level >= lib.ASDIC_LOG_WARNING:
                LOGGER.info(message)
        if status:
            sentence = text(lib.asdic_context_error(self.pointer)) or text(lib.asdic_status_text(status))
            sentence = _OPTION.sub(r"\1=True", sentence)
            messages = tuple(message for level, message in said if level == lib.ASDIC_LOG_ERROR)
            error = ERRORS.get(status, Error)("\n".join([sentence, *messages]))
            error.status, error.messages = status, messages
            raise error

    def call(self, function: Callable[..., int], *args: Any) -> None:
        """FUNCTION(*ARGS), which is short: Ctrl-C is obeyed after it."""
        with self.lock:
            self.check(function(*args))

    def run(self, function: Callable[..., int], *args: Any) -> None:
        """FUNCTION(*ARGS) in a thread, so that this one hears of signals and reports progress.

        What is raised here meanwhile interrupts the call: it ends at its next ping, beam or picture, and the
        exception goes on from here. A driver that compiles cannot be interrupted and is waited for.
        """
        with self.lock:
            status = _Call(function, args, lambda: lib.asdic_context_interrupt(self.pointer)).result(self._report)
            self._report()  # a short call may be over before the first look
            self.check(status)
            self._finish()

    def _report(self) -> None:
        while self._progress and self._done:
            self._last = self._done.pop()
            self._progress(*self._last)

    def _finish(self) -> None:
        """The last report of a call that succeeded says that all is done."""
        if self._progress and self._last:
            what, done, total = self._last
            self._last = None
            if done < total:
                self._progress(what, total, total)

    def make(self, kind: str, destroy: Callable[..., None], function: Callable[..., int], *args: Any,
             keeps: tuple[Any, ...] = ()) -> Handle:
        """What FUNCTION(*ARGS, &pointer) creates, a KIND ("asdic_mesh"), perhaps taking long."""
        place = ffi.new(kind + " **")
        try:
            self.run(function, *args, place)
        except BaseException:
            destroy(place)  # it may have been made before Ctrl-C was heard
            raise
        return Handle(kind.removeprefix("asdic_"), place, destroy, self.handle, *keeps)


_CONTEXTS: weakref.WeakSet[Context] = weakref.WeakSet()


def _end() -> None:
    """At the interpreter's end daemon threads may be in a call: it is waited for, and none begins any more."""
    for context in list(_CONTEXTS):
        if context.process == _Process.number and not context.lock.acquire(blocking=False):
            lib.asdic_context_interrupt(context.pointer)
            context.lock.acquire()


weakref.finalize(Context, int)  # what runs finalizers at the end is registered with the first: _end comes before
atexit.register(_end)


_OPENCL: list[int] = []  # the process that has used OpenCL


def prepare_opencl(context: Context, instead: str = "") -> None:
    """Before what may use OpenCL, which hangs where a parent's use has left it without threads; INSTEAD goes without."""
    if _OPENCL and _OPENCL[0] != _Process.number:
        raise fail(DeviceError, "OpenCL was used before this process was forked, and its threads are gone; "
                   f"start processes by multiprocessing's 'spawn'{instead}")
    lib.asdic_kernel_cache_prepare(context.pointer)


def note_opencl() -> None:
    """That it was used, or will be at once."""
    _OPENCL[:] = [_Process.number]


def use_opencl(context: Context) -> None:
    prepare_opencl(context)
    note_opencl()


class Devices(Handle):
    """Opened devices."""

    __slots__ = ("count",)
    count: int


def open_devices(context: Context, selector: str | None) -> Devices:
    """The devices of a selector ("auto", "cpu", "0:0", ...); pointer[0] is the first."""
    use_opencl(context)
    place, count = ffi.new("asdic_device ***"), ffi.new("size_t *")
    chosen = encoded(selector, "device") if selector is not None else ffi.NULL

    def close(opened: Any) -> None:
        lib.asdic_devices_close(opened, count[0])
    try:
        context.run(lib.asdic_devices_open, context.pointer, chosen, place, count)
    except BaseException:
        close(place)  # as in Context.make
        raise
    devices = Devices("device", place, close, context.handle)
    devices.count = int(count[0])
    return devices


# ---- text, arrays, structs -------------------------------------------------------------------


def text(pointer: Any) -> str:
    return ffi.string(pointer).decode("utf-8", "replace") if pointer else ""


def encoded(value: Any, what: str) -> bytes:
    """A str or path for the library."""
    if not isinstance(value, (str, bytes, os.PathLike)):
        raise TypeError(f"{what} is a {type(value).__name__}; it must be text")
    try:
        result = os.fsencode(value)
    except UnicodeEncodeError as error:
        raise fail(ArgumentError, f"{what} has {error.object[error.start:error.end]!r} in it, which no file can hold") from error
    if b"\0" in result:
        raise fail(ArgumentError, f"{what} has a zero byte in it")
    return result


def number(value: Any, what: str) -> float:
    """A finite float, of what is a number and no text of one."""
    if isinstance(value, (str, bytes, bool)):
        raise TypeError(f"{what} = {value!r} is not a number")
    try:
        result = float(value)
    except OverflowError:
        result = math.inf
    except (TypeError, ValueError) as error:
        raise TypeError(f"{what} = {value!r} is not a number") from error
    if not math.isfinite(result):
        raise fail(ArgumentError, f"{what} = {result} is not finite")
    return result


def whole(value: Any, what: str, low: int, high: int) -> int:
    """An integer from LOW to HIGH."""
    try:
        result = value.__index__()
    except AttributeError as error:
        raise TypeError(f"{what} = {value!r} is not an integer") from error
    if not low <= result <= high:
        raise fail(ArgumentError, f"{what} = {result} is out of range [{low}, {high}]")
    return int(result)


MASKED: Any = np.ma
"""numpy.ma, whose functions have no types."""


def masked(values: ArrayLike, what: str) -> Any:
    """VALUES as a masked array, as netCDF4 reads files."""
    try:
        return MASKED.asarray(values)
    except ValueError as error:
        raise fail(ArgumentError, f"{what} are rows of different lengths") from error


def numbers(values: ArrayLike, what: str, kinds: str = "fiu") -> Any:
    """VALUES as a masked array of numbers of these KINDS."""
    array = masked(values, what)
    if array.dtype.kind not in kinds:
        raise TypeError(f"{what} are of type {array.dtype}; they must be {'numbers' if 'f' in kinds else 'integers'}")
    return array


def doubles(values: ArrayLike, what: str) -> np.ndarray:
    """VALUES in double precision; NAN where they are masked."""
    return np.asarray(MASKED.filled(numbers(values, what).astype(np.float64, copy=False), np.nan))


def counted(count: int, what: str) -> str:
    """COUNT of WHAT: "1 ping", "2 pings"."""
    return f"{count} {what}{'s' * (count != 1)}"


class _Memory:  # pylint: disable=too-few-public-methods
    """An owner's memory, as numpy asks for it."""

    __slots__ = ("__array_interface__", "owner")
    __array_interface__: dict[str, Any]
    owner: Any


def view(pointer: Any, shape: tuple[int, ...], dtype: Any, owner: Any) -> np.ndarray:
    """The library's memory at POINTER as an array that cannot be written and keeps OWNER."""
    dtype = np.dtype(dtype)
    if 0 in shape or not pointer:
        return np.empty(shape, dtype)
    memory = _Memory()
    memory.owner = owner
    if isinstance(owner, Handle):
        owner.outlive()
    memory.__array_interface__ = {
        "version": 3, "typestr": "|u1", "shape": (math.prod(shape) * dtype.itemsize,),
        "data": (int(ffi.cast("uintptr_t", pointer)), True)}
    return np.asarray(memory).view(dtype).reshape(shape)


def table(pointer: Any, count: int, kind: str, owner: Any) -> np.ndarray:
    """A copy of the library's COUNT structs at POINTER, whose names are text."""
    rows = view(pointer, (count,), dtype_of(kind), owner)
    types = {name: np.dtype(f"U{rows.dtype[name].itemsize}") if rows.dtype[name].kind == "S" else rows.dtype[name]
             for name in rows.dtype.names or ()}
    result = np.empty(count, list(types.items()))
    for name, dtype in types.items():
        result[name] = np.char.decode(rows[name], "utf-8", "replace") if dtype.kind == "U" else rows[name]
    return result


@functools.lru_cache(maxsize=None)
def words(kind: str) -> dict[str, int]:
    """The words of an enum: {"swerling0": 0, ...} of "asdic_target"."""
    names = {name: value for value, name in sorted(ffi.typeof(kind).elements.items()) if not name.endswith("_COUNT")}
    prefix = os.path.commonprefix(list(names)).rpartition("_")[0] + "_"
    return {name[len(prefix):].lower().replace("_", "-"): value for name, value in names.items()}


def value_of(kind: str, word: str, what: str) -> int:
    """The value of WORD in the enum KIND."""
    known = words(kind)
    if not isinstance(word, str):
        raise TypeError(f"{what} = {word!r} is no text; it must be one of {', '.join(known)}")
    if word not in known:
        raise fail(ArgumentError, f"{what} = {word!r} is none of {', '.join(known)}")
    return known[word]


def _scalar(kind: Any) -> np.dtype:
    """A number of a struct, as numpy has it."""
    if kind.kind == "enum":
        return np.dtype(f"u{ffi.sizeof(kind)}")
    code = {"_Bool": "?", "double": "f", "float": "f"}.get(kind.cname)
    code = code or ("u" if kind.cname.startswith("u") or kind.cname == "size_t" else "i")
    return np.dtype(code if code == "?" else f"{code}{ffi.sizeof(kind)}")


def dtype_of(kind: Any) -> np.dtype:
    """The numpy type of a C type; a struct's without its pointers, which numpy could not follow."""
    kind = ffi.typeof(kind) if isinstance(kind, str) else kind
    if kind.kind == "array":
        item = kind.item
        return np.dtype(f"S{kind.length}") if item.cname == "char" else np.dtype((dtype_of(item), (kind.length,)))
    if kind.kind != "struct":
        return _scalar(kind)
    fields = [(name, field) for name, field in kind.fields if field.type.kind != "pointer"]
    return np.dtype({"names": [name for name, _ in fields], "formats": [dtype_of(field.type) for _, field in fields],
                     "offsets": [field.offset for _, field in fields], "itemsize": ffi.sizeof(kind)})


class Fields(SimpleNamespace):
    """A struct of the library, copied: the names and units are those of its header."""


def _python(kind: Any, value: Any) -> Any:
    if kind.kind == "struct":
        return fields(value)
    if kind.kind == "enum":
        return next((word for word, number_ in words(kind.cname).items() if number_ == int(value)), int(value))
    if kind.kind == "array":
        return text(value) if kind.item.cname == "char" else tuple(_python(kind.item, item) for item in value)
    if kind.kind == "pointer":
        return text(value) if value else None
    return value


def fields(struct: Any) -> Fields:
    """A copy of a struct, or of what a pointer to one points to; of pointers in it only texts."""
    kind = ffi.typeof(struct)
    kind = kind.item if kind.kind == "pointer" else kind
    return Fields(**{name: _python(field.type, getattr(struct, name)) for name, field in kind.fields
                     if field.type.kind != "pointer" or field.type.item.cname == "char"})
