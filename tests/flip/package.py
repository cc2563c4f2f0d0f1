"""FLIP of two images as the PyPI package flip-evaluator has it.

Arguments: LDR or HDR, width, height, pixels per degree, and the files of the
reference, of the candidate (both 32-bit little-endian floats, RGB, row by row
from the top; LDR as sRGB levels 0 to 255) and of the error map to write.
Prints one JSON object: the mean and, for HDR, the exposures.
"""

import json
import sys

import flip_evaluator
import numpy


def main():
    kind, width, height, pixels_per_degree, reference, candidate, error_map = sys.argv[1:]
    shape = (int(height), int(width), 3)
    divisor = numpy.float32(255 if kind == "LDR" else 1)

    def image(path):
        return numpy.fromfile(path, dtype="<f4").reshape(shape) / divisor

    errors, mean, parameters = flip_evaluator.evaluate(
        image(reference),
        image(candidate),
        kind,
        applyMagma=False,
        parameters={"ppd": float(pixels_per_degree)},
    )
    errors[:, :, 0].astype("<f4").tofile(error_map)
    result = {"mean": float(mean)}
    if kind == "HDR":
        for key in ("startExposure", "stopExposure", "numExposures"):
            result[key] = parameters[key]
    print(json.dumps(result))


main()
