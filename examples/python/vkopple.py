"""vkopple for Python: libvkopple through ctypes, with numpy arrays.

    with Model("run") as model:
        seen = model.see(image)      # (height, width, 3), uint8 or floats from 0 to 1
        seen.mask, seen.depth, seen.objects

VKOPPLE_LIBRARY names the library where the system does not find it.
"""

import ctypes
import os
from dataclasses import dataclass

import numpy

_STATUS = {1: "failed", 2: "wrong use", 3: "out of memory"}
_RGB8, _RGB_FLOAT32 = 0, 1
_FLOAT32, _MIXED = 0, 1


class Error(RuntimeError):
    pass


class _Options(ctypes.Structure):
    _fields_ = [("struct_size", ctypes.c_size_t), ("device", ctypes.c_char_p), ("precision", ctypes.c_int32)]


class _Image(ctypes.Structure):
    _fields_ = [("pixels", ctypes.c_void_p), ("height", ctypes.c_int32), ("width", ctypes.c_int32),
                ("stride", ctypes.c_size_t), ("format", ctypes.c_int32)]


class _Object(ctypes.Structure):
    _fields_ = [("location", ctypes.c_double * 3), ("angle", ctypes.c_double), ("distance", ctypes.c_double),
                ("yaw", ctypes.c_double), ("yaw_probability", ctypes.c_double), ("share", ctypes.c_double)]


class ModelInfo(ctypes.Structure):
    _fields_ = [("struct_size", ctypes.c_size_t), ("height", ctypes.c_int32), ("width", ctypes.c_int32),
                ("slots", ctypes.c_int32), ("bins", ctypes.c_int32), ("sees_objects", ctypes.c_int32),
                ("fov", ctypes.c_double), ("max_depth", ctypes.c_double), ("step", ctypes.c_uint64)]


@dataclass
class Object:
    location: tuple  # x right, y forward, z up, scene units
    angle: float
    distance: float
    yaw: float  # 0, as its probability, from a model that tells rotations
    yaw_probability: float
    share: float
    pose: numpy.ndarray  # probability of every bin of yaw; empty from a model that tells rotations
    rotation: "numpy.ndarray | None"  # (3, 3), object to camera; None from a model that tells yaws


@dataclass
class Seen:
    mask: numpy.ndarray  # (height, width) uint32: the slot's index, the background's is `background`
    depth: numpy.ndarray  # (height, width) float32
    background: int
    background_share: float
    objects: list
    soft_masks: "numpy.ndarray | None"  # (slots + 1, height, width) of the model's size


def _load_library():
    library = ctypes.CDLL(os.environ.get("VKOPPLE_LIBRARY", "libvkopple.so.0"))
    pointer, size = ctypes.c_void_p, ctypes.c_size_t

    def declare(name, result, *arguments):
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments

    declare("vkopple_version", ctypes.c_char_p)
    declare("vkopple_last_error", ctypes.c_char_p)
    declare("vkopple_load", ctypes.c_int, ctypes.c_char_p, ctypes.POINTER(_Options), ctypes.POINTER(pointer))
    declare("vkopple_free", None, pointer)
    declare("vkopple_get_model_info", ctypes.c_int, pointer, ctypes.POINTER(ModelInfo))
    declare("vkopple_see", ctypes.c_int, pointer, ctypes.POINTER(_Image), ctypes.POINTER(pointer))
    declare("vkopple_seen_free", None, pointer)
    declare("vkopple_seen_mask", ctypes.POINTER(ctypes.c_uint32), pointer)
    declare("vkopple_seen_depth", ctypes.POINTER(ctypes.c_float), pointer)
    declare("vkopple_seen_background", ctypes.c_uint32, pointer, ctypes.POINTER(ctypes.c_double))
    declare("vkopple_seen_objects", ctypes.POINTER(_Object), pointer, ctypes.POINTER(size))
    declare("vkopple_seen_pose", ctypes.POINTER(ctypes.c_double), pointer, size, ctypes.POINTER(size))
    declare("vkopple_seen_rotation", ctypes.POINTER(ctypes.c_double), pointer, size)
    declare("vkopple_seen_soft_masks", ctypes.POINTER(ctypes.c_float), pointer, ctypes.POINTER(size),
            ctypes.POINTER(ctypes.c_int32), ctypes.POINTER(ctypes.c_int32))
    return library


_library = _load_library()


def version():
    return _library.vkopple_version().decode()


def _check(status):
    if status != 0:
        raise Error(f"{_STATUS.get(status, status)}: {_library.vkopple_last_error().decode()}")


def _copy(pointer, shape):
    """An array that outlives the library's memory."""
    return numpy.ctypeslib.as_array(pointer, shape).copy()


class Model:
    """A trained model on a device of its own; one thread at a time."""

    def __init__(self, path, device=None, mixed=False):
        self._model = ctypes.c_void_p()
        options = _Options(ctypes.sizeof(_Options), device.encode() if device else None, _MIXED if mixed else _FLOAT32)
        _check(_library.vkopple_load(os.fsencode(path), ctypes.byref(options), ctypes.byref(self._model)))

    def close(self):
        _library.vkopple_free(self._model)
        self._model = ctypes.c_void_p()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def info(self):
        info = ModelInfo(struct_size=ctypes.sizeof(ModelInfo))
        _check(_library.vkopple_get_model_info(self._model, ctypes.byref(info)))
        return info

    def see(self, image):
        image = numpy.asarray(image)
        if image.ndim != 3 or image.shape[2] != 3:
            raise ValueError(f"an image is (height, width, 3), not {image.shape}")
        if image.dtype != numpy.uint8:
            image = image.astype(numpy.float32)
        # Rows may lie apart, as in a part of a larger image; pixels may not.
        if image.strides[1:] != (3 * image.itemsize, image.itemsize) or image.strides[0] < 3 * image.itemsize * image.shape[1]:
            image = numpy.ascontiguousarray(image)
        described = _Image(image.ctypes.data, image.shape[0], image.shape[1], image.strides[0],
                           _RGB8 if image.dtype == numpy.uint8 else _RGB_FLOAT32)
        seen = ctypes.c_void_p()
        _check(_library.vkopple_see(self._model, ctypes.byref(described), ctypes.byref(seen)))
        try:
            return _gather(seen, image.shape[:2])
        finally:
            _library.vkopple_seen_free(seen)


def _gather(seen, size):
    share = ctypes.c_double()
    background = _library.vkopple_seen_background(seen, ctypes.byref(share))
    return Seen(_copy(_library.vkopple_seen_mask(seen), size), _copy(_library.vkopple_seen_depth(seen), size),
                background, share.value, _objects(seen), _soft_masks(seen))


def _objects(seen):
    count, bins = ctypes.c_size_t(), ctypes.c_size_t()
    objects = _library.vkopple_seen_objects(seen, ctypes.byref(count))
    result = []
    for i in range(count.value):
        pose = _library.vkopple_seen_pose(seen, i, ctypes.byref(bins))
        rotation = _library.vkopple_seen_rotation(seen, i)
        o = objects[i]
        result.append(Object(tuple(o.location), o.angle, o.distance, o.yaw, o.yaw_probability, o.share,
                             _copy(pose, (bins.value,)) if pose else numpy.empty(0),
                             _copy(rotation, (3, 3)) if rotation else None))
    return result


def _soft_masks(seen):
    planes, height, width = ctypes.c_size_t(), ctypes.c_int32(), ctypes.c_int32()
    masks = _library.vkopple_seen_soft_masks(seen, ctypes.byref(planes), ctypes.byref(height), ctypes.byref(width))
    return _copy(masks, (planes.value, height.value, width.value)) if masks else None
