// The page: reads its data, keeps hour and view, and draws when something changes.
import { unpacked, PageData } from './data.js';
import { Controls } from './controls.js';
import { Headset } from './headset.js';
import { Picture } from './picture.js';
import { instantOf, wallOf } from './sun.js';

// Milliseconds of a minute, minutes of a day, and minutes that pass in a second of play.
const MINUTE = 60000, DAY = 1440, MINUTES_A_SECOND = 30;
// Milliseconds after which a pointer rests: its lux is then told by all that is seen from there.
const RESTS_MS = 150;

/** @param {string} id @returns {any} */
const part = (id) => document.getElementById(id);
/** @param {string} text */
function say(text) {
  part('message').textContent = text;
  part('message').hidden = !text;
}

function missing() {
  if (typeof DecompressionStream === 'undefined') return 'This browser is too old to unpack the scene: any of 2023 or later can.';
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl) return 'This browser draws no WebGL2, which the living scene needs. Four hours of it are shown instead.';
  if (!gl.getExtension('EXT_color_buffer_float')) return 'This graphics card draws no floating-point pictures, which the living scene needs. Four hours of it are shown instead.';
  return '';
}

function showStills() {
  part('stills').hidden = false;
  document.body.classList.add('still');
}

export class Page {
  /** @param {PageData} data */
  constructor(data) {
    this.header = data.header;
    this.zone = data.header.place.zone;
    this.canvas = part('picture');
    this.view = new Picture(data, this.canvas);
    const { lower, upper } = data.header.scene;
    this.controls = new Controls(this.view.camera, this.canvas, { lower, upper }, () => this.change());
    const start = wallOf(this.zone, Date.parse(data.header.start));
    this.year = new Date(start).getUTCFullYear();
    this.day = Math.floor((start - Date.UTC(this.year, 0, 1)) / (DAY * MINUTE));
    this.minute = (start / MINUTE) % DAY;
    this.plays = false;
    this.hourChanged = true;
    this.dirty = true;
    this.dragging = false;
    this.moved = false;
    this.drafted = false;
    this.fixed = 12;
    this.barDay = -1;
    this.last = 0;
    this.frames = 0;
    /** @type {{x: number, y: number} | null} */
    this.pointer = null;
    /** Timer of a pointer that rests. */
    this.rests = 0;
    this.headset = new Headset(this);
  }

  /** Something moved: the picture begins anew. */
  change() {
    this.dirty = true;
    this.view.stillCount = 0;
  }

  get date() {
    return instantOf(this.zone, Date.UTC(this.year, 0, 1) + (this.day * DAY + this.minute) * MINUTE);
  }

  /** @param {number} day @param {number} minute of its clock */
  setHour(day, minute) {
    this.day = ((Math.floor(day + Math.floor(minute / DAY)) % 366) + 366) % 366;
    this.minute = ((minute % DAY) + DAY) % DAY;
    this.hourChanged = true;
    this.change();
  }

  readLink() {
    const found = /^#(\d{4})-(\d\d)-(\d\d)T(\d\d):(\d\d)/.exec(location.hash);
    if (!found) return;
    const [year, month, day, hour, minute] = found.slice(1).map(Number);
    const at = Date.UTC(year, month - 1, day);
    if (month < 1 || month > 12 || day < 1 || day > 31 || hour > 23 || minute > 59) return;
    this.year = year;
    this.setHour((at - Date.UTC(year, 0, 1)) / (DAY * MINUTE), hour * 60 + minute);
  }

  text() {
    const wall = new Date(Date.UTC(this.year, 0, 1) + (this.day * DAY + this.minute) * MINUTE);
    return wall.toISOString().slice(0, 16);
  }

  layOut() {
    if (this.headset.session) return;
    const box = this.canvas.parentElement.getBoundingClientRect();
    const most = this.view.soft ? 1 : 2;
    this.view.resize(Math.max(box.width, 16), Math.max(box.height, 16), Math.min(devicePixelRatio || 1, most));
    this.change();
  }

  /** Colours of the day along the hour's slider: night, twilight, day. */
  drawBar() {
    const bar = part('bar'), pen = bar.getContext('2d'), width = (bar.width = 288);
    bar.height = 1;
    for (let x = 0; x < width; ++x) {
      const wall = Date.UTC(this.year, 0, 1) + (this.day + x / width) * DAY * MINUTE;
      const height = this.view.ephemeris.sun(instantOf(this.zone, wall)).apparentRad * 180 / Math.PI;
      pen.fillStyle = height > 6 ? '#bcd9f5' : height > -0.27 ? '#f4c98a' : height > -6 ? '#8a6f9e'
        : height > -12 ? '#4a4a7d' : height > -18 ? '#2b2d55' : '#15172f';
      pen.fillRect(x, 0, 1, 1);
    }
    this.barDay = this.day;
  }

  /** Clock, date, and where sun or moon stand, in words. */
  words() {
    const { sun, moon } = this.view, degrees = (/** @type {number} */ rad) => (rad * 180 / Math.PI).toFixed(1);
    const wall = new Date(Date.UTC(this.year, 0, 1) + (this.day * DAY + this.minute) * MINUTE);
    let body = sun ? `sun ${degrees(-sun.apparentRad)}° below the horizon` : '';
    if (sun && sun.apparentRad > -0.0047) body = `sun ${degrees(sun.apparentRad)}° high`;
    else if (moon && moon.apparentRad > 0) body = `moon ${degrees(moon.apparentRad)}° high, ${Math.round(100 * moon.lit)} % lit`;
    return [wall.toISOString().slice(11, 16),
      wall.toLocaleDateString('en-GB', { day: 'numeric', month: 'long', timeZone: 'UTC' }), body];
  }

  tell() {
    const [clock, date, body] = this.words();
    part('clock').textContent = clock;
    part('date').textContent = date;
    part('sun').textContent = body;
    part('hour').value = String(this.minute);
    part('hour').setAttribute('aria-valuetext', part('clock').textContent);
    part('day').value = String(this.day);
    part('day').setAttribute('aria-valuetext', part('date').textContent);
    part('ev').textContent = `EV ${this.view.ev.toFixed(1)}`;
    const link = `#${this.text()}`;
    if (location.hash !== link && !this.plays && !this.dragging) history.replaceState(null, '', link);
  }

  turnNorth() {
    const d = this.view.camera.getWorldDirection(this.controls.target.clone());
    const heading = Math.atan2(d.x, -d.z) + this.header.place.north_offset_rad;
    part('needle').style.transform = `rotate(${-heading}rad)`;
  }

  /** @param {number} now ms */
  frame(now) {
    requestAnimationFrame((next) => this.frame(next));
    const seconds = Math.min((now - this.last) / 1000, 0.1);
    this.last = now;
    if (this.headset.session) return;
    if (this.plays) this.setHour(this.day, this.minute + seconds * MINUTES_A_SECOND);
    this.controls.advance(seconds);
    if (!this.dirty) {
      this.moved = false;
      return;
    }
    // Where the last picture moved too, its time is that since then.
    if (this.moved) this.view.keepPace(seconds);
    this.moved = this.moves;
    this.step();
  }

  /** Whether hour or view go on moving. */
  get moves() {
    return this.plays || this.dragging || this.controls.fingers.size > 0 || this.controls.keys.size > 0;
  }

  step() {
    const { view, moves } = this;
    this.lightHour(moves);
    const first = view.stillCount === 0, before = view.ev;
    this.dirty = view.draw(!moves) && !moves;
    // The exposure that was just metered is that of the next picture.
    if (first && Math.abs(view.ev - before) > 0.02) this.dirty = true;
    if (first && view.values) this.scale();
    ++this.frames;
    this.tell();
    this.turnNorth();
    if (first && this.pointer) this.tellLux();
    if (!moves && this.barDay !== this.day) this.drawBar();
  }

  /** Lights the scene at the present hour. @param {boolean} moves whether the hour goes on moving */
  lightHour(moves) {
    const { view } = this;
    if (!this.hourChanged && (moves || !this.drafted)) return;
    this.drafted = moves && view.soft;
    view.setHour(this.date, this.drafted);
    this.hourChanged = false;
  }

  /** The range of false colours. */
  scale() {
    const { view } = this;
    view.meterValues();
    const [low, high] = view.range;
    const said = (/** @type {number} */ v) => (v >= 100 ? Math.round(v).toLocaleString('en') : v.toPrecision(2));
    part('low').textContent = `${said(low)} lx`;
    part('middle').textContent = said(Math.sqrt(low * high));
    part('high').textContent = `${said(high)} lx`;
  }

  tellLux() {
    if (!this.pointer) return;
    const { numbers } = this.view;
    if (numbers && numbers.shown >= 0) {
      const { width, height } = this.canvas.getBoundingClientRect();
      part('lux').textContent = numbers.at(this.view.camera, this.pointer.x, this.pointer.y, width, height);
      return;
    }
    const { x, y } = this.pointer;
    const said = (/** @type {number} */ lux) => `${lux >= 100 ? Math.round(lux).toLocaleString('en') : lux.toPrecision(3)} lx`;
    const all = this.view.points.byMap(x, y);
    part('lux').textContent = Number.isFinite(all) ? `≈ ${said(all)}` : '';
    clearTimeout(this.rests);
    if (!Number.isFinite(all) || this.moves || this.header.scene.lamps) return;
    this.rests = setTimeout(() => {
      if (!this.moves) part('lux').textContent = said(this.view.points.gathered(x, y));
    }, RESTS_MS);
  }

  /** @param {string} name */
  showView(name) {
    const view = this.header.views[name];
    if (!view) return;
    this.controls.look(view);
  }

  listen() {
    const { canvas } = this;
    for (const [id, set] of /** @type {[string, (v: number) => void][]} */ ([
      ['hour', (v) => this.setHour(this.day, v)], ['day', (v) => this.setHour(v, this.minute)],
    ])) {
      const slider = part(id);
      slider.addEventListener('input', () => { this.dragging = true; set(Number(slider.value)); });
      slider.addEventListener('change', () => { this.dragging = false; this.change(); });
    }
    part('play').addEventListener('click', () => this.play());
    part('values').addEventListener('click', () => this.showValues());
    part('walk').addEventListener('click', () => this.walk());
    part('auto').addEventListener('click', () => this.automatic(!this.view.exposure.automatic));
    part('exposure').addEventListener('input', () => {
      const wanted = Number(part('exposure').value);
      const { exposure } = this.view;
      if (exposure.automatic) exposure.compensation = wanted;
      else exposure.ev = this.fixed - wanted;
      this.change();
    });
    part('views').addEventListener('change', () => this.showView(part('views').value));
    part('numbers').addEventListener('change', () => this.showNumber(Number(part('numbers').value)));
    part('headset').addEventListener('click', () => this.wear());
    part('about-open').addEventListener('click', () => part('about').showModal());
    canvas.addEventListener('pointermove', (/** @type {PointerEvent} */ event) => {
      const box = canvas.getBoundingClientRect();
      this.pointer = { x: event.clientX - box.left, y: event.clientY - box.top };
      if (!this.controls.fingers.size) this.tellLux();
    });
    canvas.addEventListener('pointerup', () => this.change());
    canvas.addEventListener('pointerleave', () => { clearTimeout(this.rests); this.pointer = null; part('lux').textContent = ''; });
    addEventListener('resize', () => this.layOut());
    addEventListener('hashchange', () => this.readLink());
    addEventListener('keydown', (event) => this.key(event));
    addEventListener('keyup', (event) => { this.controls.keys.delete(event.key.toLowerCase()); this.change(); });
    addEventListener('blur', () => this.controls.keys.clear());
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.target instanceof HTMLSelectElement || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = event.shiftKey ? 60 : 10, key = event.key.toLowerCase();
    const slides = event.target instanceof HTMLInputElement;
    if (key === ' ' && !(event.target instanceof HTMLButtonElement)) this.play();
    else if (key === 'arrowleft' && !slides) this.setHour(this.day, this.minute - step);
    else if (key === 'arrowright' && !slides) this.setHour(this.day, this.minute + step);
    else if (key === 'arrowup' && !slides) this.setHour(this.day + 1, this.minute);
    else if (key === 'arrowdown' && !slides) this.setHour(this.day - 1, this.minute);
    else if (key === 'f') this.showValues();
    else if (key === 'v') this.walk();
    else if (key === 'x') this.automatic(!this.view.exposure.automatic);
    else if ('wasdqe'.includes(key) && key.length === 1) { this.controls.keys.add(key); this.change(); return; }
    else return;
    event.preventDefault();
  }

  play() {
    this.plays = !this.plays;
    part('play').setAttribute('aria-pressed', String(this.plays));
    part('play').textContent = this.plays ? '❚❚' : '▶';
    this.change();
  }

  showValues() {
    this.view.values = !this.view.values;
    if (this.view.values) this.showNumber(-1);
    part('values').setAttribute('aria-pressed', String(this.view.values));
    part('legend').hidden = !this.view.values;
    part('quantity').textContent = 'illuminance';
    this.change();
  }

  /** Shows a quantity of the numbers, or none. @param {number} number */
  showNumber(number) {
    const { numbers } = this.view;
    if (!numbers) return;
    if (number >= 0 && this.view.values) this.showValues();
    numbers.show(number);
    part('numbers').value = String(number);
    part('legend').hidden = number < 0;
    if (number >= 0) {
      const [low, high] = numbers.range;
      part('quantity').textContent = numbers.about.names[number];
      part('low').textContent = numbers.text(low);
      part('middle').textContent = numbers.text(0.5 * (low + high));
      part('high').textContent = numbers.text(high);
    }
    this.change();
  }

  walk() {
    const { controls } = this;
    controls.walks = !controls.walks;
    part('walk').setAttribute('aria-pressed', String(controls.walks));
  }

  /** Enters or leaves the scene with a headset. */
  async wear() {
    const { session } = this.headset;
    try {
      await (session ? session.end() : this.headset.enter());
      say('');
    } catch (fault) {
      say(`The headset cannot be entered: ${/** @type {Error} */ (fault).message || fault}`);
    }
    this.showHeadset();
  }

  showHeadset() {
    part('headset').textContent = this.headset.session ? 'Leave VR' : 'Enter VR';
  }

  /** @param {boolean} on */
  automatic(on) {
    const { exposure } = this.view;
    this.fixed = this.view.ev;
    Object.assign(exposure, { automatic: on, ev: this.view.ev, compensation: 0 });
    part('auto').setAttribute('aria-pressed', String(on));
    part('exposure').value = '0';
    this.change();
  }
}

async function start() {
  const reason = missing();
  if (reason) {
    say(reason);
    showStills();
    return;
  }
  const data = new PageData(await unpacked('data'));
  const page = new Page(data);
  await page.view.load(await unpacked('scene'));
  const { header } = data;
  for (const name of Object.keys(header.views)) part('views').add(new Option(name, name));
  part('views').hidden = Object.keys(header.views).length < 2;
  const { numbers } = page.view;
  if (numbers) {
    part('numbers').hidden = false;
    part('numbers').add(new Option('numbers', '-1'));
    numbers.about.names.forEach((/** @type {string} */ name, /** @type {number} */ n) => (
      part('numbers').add(new Option([name, numbers.about.units[n]].filter(Boolean).join(', '), String(n)))));
  }
  part('where').textContent = header.place.text;
  part('facts').textContent = header.facts.join('\n');
  part('day').max = String(header.year_days - 1);
  page.showView(Object.keys(header.views)[0]);
  page.listen();
  page.readLink();
  part('headset').hidden = !await Headset.isThere();
  page.layOut();
  // The first picture is one of those that move, so that it is soon there.
  page.dragging = true;
  page.step();
  page.dragging = false;
  page.change();
  part('wait').hidden = true;
  document.body.classList.add('ready');
  // The browser shows this picture with its first frame; the next picture would hold that frame up
  // while its programs are compiled.
  requestAnimationFrame(() => requestAnimationFrame((now) => page.frame(now)));
  // For scripts and tests.
  Object.assign(window, { daylight: page });
}

start().catch((fault) => {
  part('wait').hidden = true;
  say(`The scene cannot be shown: ${fault.message || fault}`);
  showStills();
  throw fault;
});
