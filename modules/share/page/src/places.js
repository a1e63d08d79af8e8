// Places of sun and moon for which light is known, and weights between them: the twin of
// share/sun_places.py.
import { clamp, placed } from './sky.js';

/** @typedef {{trueRad: number, declination: number, hour: number, northRad: number}} At a body:
 * geometric height, declination, hour angle and azimuth from north */

/** Weights of four even nodes about t (Catmull and Rom 1974). @param {number} t */
function cubic(t) {
  return [0.5 * t * (t * (2 - t) - 1), 0.5 * (t * t * (3 * t - 5) + 2),
    0.5 * t * (t * (4 - 3 * t) + 1), 0.5 * t * t * (t - 1)];
}

/** Share of a full turn, in [0, 1). @param {number} rad */
const turned = (rad) => ((rad / (2 * Math.PI)) % 1 + 1) % 1;

/** Places and weights for a body. @param {any} places of the header @param {At} at
 * @returns {[number, number][]} */
export function placeWeights(places, at) {
  const [low, high] = places.takes_over_rad;
  const day = clamp((at.trueRad - low) / (high - low), 0, 1);
  /** @type {[number, number][]} */
  const found = [];
  if (day > 0) addDay(places, at, day, found);
  if (day < 1) addDusk(places, at, 1 - day, found);
  return found;
}

/** @param {any} places @param {At} at @param {number} share @param {[number, number][]} found */
function addDay(places, at, share, found) {
  const { declinations, hours, most_declination: most, day_nodes: nodes } = places;
  const v = clamp((at.declination + most) / (2 * most) * (declinations - 1), 0, declinations - 1);
  const u = turned(at.hour) * hours % hours;
  const row = Math.min(Math.floor(v), declinations - 2), column = Math.floor(u);
  const along = cubic(u - column);
  let across = cubic(v - row);
  // Beyond the first and the last row light goes on evenly.
  if (row === 0) across = [0, across[1] + 2 * across[0], across[2] - across[0], across[3]];
  if (row === declinations - 2) {
    across = [across[0], across[1] - across[3], across[2] + 2 * across[3], 0];
  }
  for (let j = 0; j < 4; ++j) {
    if (!across[j]) continue;
    for (let i = 0; i < 4; ++i) {
      const node = nodes[row + j - 1][(column + i - 1 + hours) % hours];
      found.push([node, share * across[j] * along[i]]);
    }
  }
}

/** @param {any} places @param {At} at @param {number} share @param {[number, number][]} found */
function addDusk(places, at, share, found) {
  const { dusk_rad: heights, dusk_azimuths: count, first_of_dusk: first } = places;
  const [row, t] = placed(heights, at.trueRad), u = turned(at.northRad) * count % count;
  const column = Math.floor(u), along = cubic(u - column);
  for (let j = 0; j < 2; ++j) {
    for (let i = 0; i < 4; ++i) {
      found.push([first + (row + j) * count + (column + i - 1 + count) % count,
        share * (j ? t : 1 - t) * along[i]]);
    }
  }
}
