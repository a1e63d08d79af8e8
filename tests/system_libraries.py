"""The system libraries that set-up looks for, by group and in this order."""

LIBRARIES = {
    "gl": ("libEGL.so.1", "libGL.so.1"),
    "qt": ("libglib-2.0.so.0", "libfontconfig.so.1", "libxkbcommon.so.0", "libdbus-1.so.3"),
    "x11": (
        "libxcb-cursor.so.0", "libxcb-icccm.so.4", "libxcb-keysyms.so.1", "libxcb-image.so.0",
        "libxcb-render-util.so.0", "libxcb-shape.so.0", "libxcb-xkb.so.1",
        "libxkbcommon-x11.so.0",
    ),
    "mitsuba": ("libatomic.so.1",),
    "llvm": ("libLLVM.so.19.1",),
}  # fmt: skip
