// Exposure: the twin of vrut_lite/pictures/exposure.py, whose docstring explains its rules.
import { clamp } from './sky.js';

const MIDDLE_GREY = 0.18, SATURATION = 1.2, LUMENS_PER_WATT = 683, DARKEST_EV = -11;
const DARKNESS = [0.3, 4.5], FULL_ADAPTATION = 9, CONES_ALONE_CD = 5;

/** Factor from radiance to picture values. @param {number} ev */
export const scaleOf = (ev) => LUMENS_PER_WATT / (SATURATION * 2 ** ev);

/** @param {number} x @param {[number, number]} xs @param {[number, number]} ys */
const ramp = (x, xs, ys) => ys[0] + (ys[1] - ys[0]) * clamp((x - xs[0]) / (xs[1] - xs[0]), 0, 1);

/** Linear quantile as numpy has it. @param {Float64Array | Float32Array} sorted @param {number} q */
function quantile(sorted, q) {
  const at = q * (sorted.length - 1), low = Math.floor(at), t = at - low;
  return sorted[low] * (1 - t) + sorted[Math.min(low + 1, sorted.length - 1)] * t;
}

/** Automatic EV100 of luminances (W m^-2 sr^-1). @param {Float32Array} values @param {number} white */
export function automaticEv(values, white) {
  values.sort();
  const darkest = MIDDLE_GREY / scaleOf(DARKEST_EV);
  const kept = values.subarray(0, Math.max(1, Math.floor(values.length * (1 - 0.002))));
  const mean = meanStops(Float64Array.from(kept, (v) => Math.log2(Math.max(v, darkest))));
  let metered = mean + Math.log2(LUMENS_PER_WATT / (SATURATION * MIDDLE_GREY));
  if (white > 0 && metered >= FULL_ADAPTATION) {
    const highlight = Math.max(quantile(values, 0.99), darkest);
    metered -= ramp(metered, [FULL_ADAPTATION, 12], [0, 1])
      * correction(Math.log2(white) - mean, Math.log2(highlight) - mean);
  }
  return metered + Math.min(DARKNESS[0] * Math.max(0, FULL_ADAPTATION - metered), DARKNESS[1]);
}

/** @param {number} card @param {number} highlight */
function correction(card, highlight) {
  const incident = -Math.log2(MIDDLE_GREY), headroom = Math.max(4 - highlight, 0);
  const bright = incident + 0.7 - card, to = Math.min(Math.max(incident + 2 - card, 0), 1);
  const raised = Math.min(Math.max(bright, to), headroom);
  const lowered = Math.min(Math.max(card - incident, 0), 1) * ramp(card, [4.5, 6], [1, 0]);
  const full = ramp(card - highlight, [2, 2.75], [1, 0]);
  return full * raised - (1 - full) * lowered;
}

/** @param {Float64Array} stops rising */
function meanStops(stops) {
  const floor = quantile(stops, 0.9) - 4;
  let unlit = 0;
  while (unlit < stops.length && stops[unlit] < floor + 4 - 10.5) ++unlit;
  if (unlit) { stops.fill(floor, 0, unlit); stops.sort(); }
  const first = Math.floor(0.1 * stops.length), last = Math.floor(0.6 * stops.length);
  let walls = 0;
  for (let i = first; i < Math.max(last, first + 1); ++i) walls += stops[i];
  walls /= Math.max(last, first + 1) - first;
  let sum = 0, counts = 0;
  const least = Math.min(floor, walls);
  for (const stop of stops) {
    const above = Math.max(stop, least) - walls, count = ramp(above, [4.5, 6.5], [1, 0]);
    sum += count * above;
    counts += count;
  }
  return walls + sum / counts;
}

/** Luminance (cd m^-2) to which an eye is adapted; 0 where cones see alone. @param {number} ev */
export function adaptedCd(ev) {
  const darker = Math.max(0, FULL_ADAPTATION - ev) / (1 - DARKNESS[0]);
  const metered = ev - Math.min(DARKNESS[0] * darker, DARKNESS[1]);
  const field = MIDDLE_GREY * SATURATION * 2 ** metered;
  return field >= CONES_ALONE_CD ? 0 : field;
}
