"""Find the few wavelengths, and the matrix, that turn clear skylight into linear sRGB.

Run from the repository's root: python -m vrut_lite_lab.colour_fit.fit
It prints the constant RGB_OF_TRANSFER of vrut_lite/geometry/colour.py for its SKYLIGHT_NM, how far
it errs in skies that it was not fitted to, and which wavelengths would do better. Some five minutes
on one core.

The matrix M (C, 3) makes rgb = t M of t, radiance over solar irradiance: least squares of the
error over the luminance beside which it is seen. Every set of wavelengths on a grid of 5 nm is
fitted; of the best forty the one with the least fourth power of the error is taken, for the
sake of the largest errors.
"""

from itertools import combinations

import numpy as np

from vrut_lite.geometry.colour import SKYLIGHT_NM, luminance
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.colour_fit.skies import FINE_NM, TO_FIT, TO_TEST, Skies, compute, rgb_of

CANDIDATES_NM = np.arange(410.0, 681.0, 5.0)
FINALISTS = 40
_AT_A_TIME = 50_000
SUN_BANDS_DEG = ((20, 91), (5, 20), (1, 5), (-2, 1), (-5, -2), (-9, -5))
PARTS = ("molecules once and all orders above", "aerosol once", "sky on level ground")


def main() -> None:
    """Compute the skies, fit four wavelengths, and print what others would do."""
    to_fit, to_test = (compute(skies, lambda line: print(line)) for skies in (TO_FIT, TO_TEST))
    matrix = fitted(to_fit, np.array(SKYLIGHT_NM))
    print("RGB_OF_TRANSFER =", matrix.round(2).tolist())
    print_errors(to_test, np.array(SKYLIGHT_NM), matrix)
    print("best four:", best_wavelengths(to_fit, 4, CANDIDATES_NM))
    for count in (3, 4, 5, 6):
        chosen = best_wavelengths(to_fit, count, CANDIDATES_NM[::2])
        print(f"{count} wavelengths on a grid of 10 nm: {chosen}")
        for name, skies in (("fitted", to_fit), ("others", to_test)):
            print(f"  {name:7}", summary(error_percent(skies, chosen, fitted(to_fit, chosen))))


def best_wavelengths(skies: Skies, count: int, candidates_nm: FloatArray) -> FloatArray:
    """So many wavelengths (count,) of the candidates, red first."""
    samples, target = _weighed(skies, candidates_nm)
    sets = np.array(list(combinations(range(candidates_nm.size), count)))
    square, product = samples.T @ samples, samples.T @ target
    explained = []
    for some in np.array_split(sets, -(-len(sets) // _AT_A_TIME)):
        right = product[some]
        left = np.linalg.solve(square[some[:, :, None], some[:, None, :]], right)
        explained.append((left * right).sum(axis=(1, 2)))
    finalists = sets[np.argsort(-np.concatenate(explained))[:FINALISTS]]
    chosen = min(finalists, key=lambda one: _fourth_power(samples[:, one], target))
    return np.asarray(candidates_nm[chosen][::-1])


def fitted(skies: Skies, wavelength_nm: FloatArray) -> FloatArray:
    """The matrix (C, 3)."""
    return np.asarray(np.linalg.lstsq(*_weighed(skies, wavelength_nm), rcond=None)[0])


def error_percent(skies: Skies, wavelength_nm: FloatArray, matrix: FloatArray) -> FloatArray:
    """Errors (n, 4) of red, green, blue and luminance, of the luminance beside which they are."""
    samples, target = _weighed(skies, wavelength_nm)
    difference = samples @ matrix - target
    return 100.0 * np.abs(np.column_stack([difference, luminance(difference)]))


def summary(error: FloatArray) -> str:
    """Means, 99th percentiles and largest, in one line."""
    columns = error.mean(axis=0), np.quantile(error, 0.99, axis=0), error.max(axis=0)
    names = ("mean", "99 %", "largest")
    return "  ".join(
        f"{name} {' '.join(f'{v:5.2f}' for v in values)}"
        for name, values in zip(names, columns, strict=True)
    )


def print_errors(skies: Skies, wavelength_nm: FloatArray, matrix: FloatArray) -> None:
    """By the sun's elevation and the part of the light: red, green, blue, luminance."""
    error = error_percent(skies, wavelength_nm, matrix)
    print(f"{'all':24}", summary(error))
    for low, high in SUN_BANDS_DEG:
        of_band = (skies.sun_deg >= low) & (skies.sun_deg < high)
        print(f"{f'sun {low} to {high} degrees':24}", summary(error[of_band]))
    for part, name in enumerate(PARTS):
        print(f"{name:24}", summary(error[skies.part == part]))
    for turbidity in np.unique(skies.turbidity):
        print(f"{f'turbidity {turbidity}':24}", summary(error[skies.turbidity == turbidity]))


def _weighed(skies: Skies, wavelength_nm: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Samples (n, C) and true colours (n, 3), over the luminance that errors count against."""
    beside = skies.counts_against[:, None]
    at = np.searchsorted(FINE_NM, wavelength_nm)
    return skies.transfer[:, at] / beside, rgb_of(skies.transfer) / beside


def _fourth_power(samples: FloatArray, target: FloatArray) -> float:
    matrix = np.linalg.lstsq(samples, target, rcond=None)[0]
    return float(((samples @ matrix - target) ** 4).sum())


if __name__ == "__main__":
    main()
