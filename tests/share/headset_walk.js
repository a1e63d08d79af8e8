// A walk with an emulated headset, for tests; resolves to what is seen on the way.
async function walk() {
  const page = window.daylight, { headset } = page, button = document.getElementById('headset');
  const device = window.emulated, { left, right } = device.controllers, found = {};
  device.position.set(0.3, 1.6, 0.2);
  left.position.set(0.1, 1.35, -0.3);
  right.position.set(0.5, 1.3, -0.1);
  const frames = (count) => new Promise((done) => {
    let rest = count;
    const tick = () => (--rest > 0 ? headset.session.requestAnimationFrame(tick) : done());
    headset.session.requestAnimationFrame(tick);
  });
  const place = () => page.view.camera.matrixWorld.elements.slice();
  // Within a frame, after the page has drawn it.
  const seen = () => ({
    eyes_m: headset.eyes.map(({ camera }) => camera.matrixWorld.elements.slice(12, 15)),
    ahead: headset.eyes[0].camera.matrixWorld.elements.slice(8, 11).map((v) => -v),
    minute: page.minute, ring: headset.marks.ring.visible, clock: headset.marks.text,
    exposure: page.view.ev, picture: page.canvas.toDataURL(),
  });
  const point = (tilt) => right.quaternion.set(Math.sin(tilt / 2), 0, 0, Math.cos(tilt / 2));
  const go = async (tilt) => {
    point(tilt);
    right.updateButtonValue('trigger', 1);
    await frames(2);
    const aimed = seen();
    right.updateButtonValue('trigger', 0);
    await frames(2);
    return [aimed, seen()];
  };
  const push = async (hand, along, count) => {
    hand.updateAxis('thumbstick', 'x-axis', along);
    await frames(count);
    hand.updateAxis('thumbstick', 'x-axis', 0);
    await frames(2);
    return seen();
  };
  found.view = place();
  button.click();
  while (!headset.session) await new Promise((done) => setTimeout(done, 20));
  await frames(3);
  found.entered = seen();
  [found.aimed, found.gone] = await go(-0.6);
  [found.at_wall, found.stayed] = await go(0.1);
  found.turned = await push(right, 1, 4);
  found.later = await push(left, 1, 4);
  right.connected = false;
  await frames(2);
  left.updateButtonValue('squeeze', 1);
  await frames(2);
  left.updateButtonValue('squeeze', 0);
  await frames(2);
  found.one_hand = seen();
  button.click();
  while (headset.session) await new Promise((done) => setTimeout(done, 20));
  page.step();
  found.left = { view: place(), minute: page.minute, button: button.textContent };
  return found;
}
