"""How far two images are apart, by numpy and the PyPI package flip-evaluator.

Arguments: LDR or HDR, width, height, and the files of the reference, of the
candidate (32-bit little-endian floats, RGBA, row by row from the top; LDR as
sRGB levels 0 to 255) and, or "-", of the mask (one float a pixel, levels of
grey). Prints one JSON object; what is not finite is null.
"""

import json
import sys

import flip_evaluator
import numpy

BLOCK = 8


def linear_from_srgb(levels):
    x = levels / 255.0
    return numpy.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def ratio(a, b):
    return 0.0 if a == 0.0 else a / b


def block_means(image):
    height, width = image.shape[:2]
    rows = [
        [
            image[y : y + BLOCK, x : x + BLOCK].reshape(-1, 3).mean(axis=0)
            for x in range(0, width, BLOCK)
        ]
        for y in range(0, height, BLOCK)
    ]
    return numpy.array(rows)


def relative_rmse(reference, candidate):
    squares = ((candidate - reference) ** 2).sum()
    return float(numpy.sqrt(ratio(squares, (reference**2).sum())))


def flip_figures(kind, reference, candidate, counted):
    divisor = 255.0 if kind == "LDR" else 1.0
    errors, _, _ = flip_evaluator.evaluate(
        (reference / divisor).astype("f4"),
        (candidate / divisor).astype("f4"),
        kind,
        applyMagma=False,
    )
    errors = errors[:, :, 0].astype("f8")[counted]
    places = {"flip_median": 50, "flip_p95": 95, "flip_p99": 99, "flip_max": 100}
    figures = {key: float(numpy.percentile(errors, place)) for key, place in places.items()}
    return {"flip_mean": float(errors.mean()), **figures}


def main():
    kind, width, height, reference, candidate, mask = sys.argv[1:]
    shape = (int(height), int(width))

    def read(path, channels):
        return numpy.fromfile(path, dtype="<f4").astype("f8").reshape(shape + channels)

    reference, candidate = read(reference, (4,)), read(candidate, (4,))
    grey = numpy.zeros(shape) if mask == "-" else read(mask, ())
    counted = grey < 255.0
    finite = numpy.isfinite(reference).all(axis=2) & numpy.isfinite(candidate).all(axis=2)
    with numpy.errstate(invalid="ignore"):
        largest = numpy.abs(candidate - reference).max(axis=2)
    largest[~finite] = numpy.inf

    allowed = grey * (1.0 if kind == "LDR" else 1.0 / 255.0)
    excused = ~counted | (largest <= allowed)
    colours = reference[:, :, :3], candidate[:, :, :3]
    shown = [numpy.where(counted[:, :, None], image, 0.0) for image in colours]
    linear = [linear_from_srgb(image) if kind == "LDR" else image for image in shown]
    figures = {
        "differing_pixels": int((largest[counted] > 0.0).sum()),
        "non_finite_pixels": int((~finite & counted).sum()),
        "max_channel_difference": float(largest[counted].max()),
        "rmse": float(numpy.sqrt(((shown[1] - shown[0]) ** 2).sum() / (3 * counted.sum()))),
        "relative_rmse": relative_rmse(*linear),
        "bias": float(ratio(linear[1].sum() - linear[0].sum(), linear[0].sum())),
        "relative_rmse_8x8": relative_rmse(*map(block_means, linear)),
    }
    if finite.all():
        seen = numpy.where(excused[:, :, None], colours[0], colours[1])
        figures.update(flip_figures(kind, colours[0], seen, counted))
    figures = {key: x if numpy.isfinite(x) else None for key, x in figures.items()}
    print(json.dumps(figures))


main()
