"""Pixels of a page's own shader, drawn by OpenGL."""

import moderngl
import numpy as np


def full_screen(context, made, program, size):
    """Pixels (n, 4) of a program that fills a target; `made` keeps resources to be released."""
    target = made(context.texture(size, 4, dtype="f4"))
    frame = made(context.framebuffer([target]))
    triangle = made(context.buffer(np.float32([-1, -1, 0, 3, -1, 0, -1, 3, 0]).tobytes()))
    surface = made(context.vertex_array(program, [(triangle, "3f", "position")]))
    frame.use()
    context.disable(moderngl.BLEND | moderngl.DEPTH_TEST | moderngl.CULL_FACE)
    surface.render()
    found = np.frombuffer(target.read(), np.float32).reshape(-1, 4)
    context.extra.use()
    return found
