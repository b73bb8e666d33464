"""The library as cffi binds it from the public headers: lib.asdic_... are its functions and constants."""
from typing import Any

ffi: Any
lib: Any
