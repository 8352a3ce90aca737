# SPDX-License-Identifier: MIT
"""Say of a window what a window manager says when it makes it an icon. usage: wm_state.py WINDOW iconic|normal"""
import ctypes
import sys

x11 = ctypes.CDLL("libX11.so.6")
x11.XOpenDisplay.restype = ctypes.c_void_p
display = ctypes.c_void_p(x11.XOpenDisplay(None))
window = ctypes.c_ulong(int(sys.argv[1]))
atom = ctypes.c_ulong(x11.XInternAtom(display, b"WM_STATE", 0))
state = (ctypes.c_ulong * 2)({"normal": 1, "iconic": 3}[sys.argv[2]], 0)
x11.XChangeProperty(display, window, atom, atom, 32, 0, ctypes.byref(state), 2)
x11.XSync(display, 0)
