// Plays a movie of tip and surface. Runs as the one callback of all its controls; what was shipped
// stays as it is, and nothing that moves is sent to the server.

let place = 0;  // in the movie, in frames
let last = null;  // when the last frame was drawn, ms; null while paused
let shown = 0;  // the frame that is drawn

function fill(source, columns) {
  Object.assign(source.data, columns);
  source.change.emit();
}

// Bokeh's arrays cannot be sliced themselves: theirs are constructed otherwise than JavaScript's.
const part = (values, start, end) => Array.prototype.slice.call(values, start, end);

function heights(half, quantum, edge) {
  const n = half.length, filled = new Float64Array(2 * n + 2);
  for (let i = 0; i < n; i++)
    filled[n - 1 - i] = filled[n + i] = quantum * half[i];
  filled[2 * n] = filled[2 * n + 1] = edge;
  return filled;
}

function show(args, index) {
  const { frames, curve, quantum, ends } = args;
  const { apex, time, height, force } = frames.data, n = args.rise.data.rise.length;
  const tip = Array.from(args.rise.data.rise, rise => rise + apex[index]);
  const surface = part(args.surface.data.surface, index * n, (index + 1) * n);
  fill(args.tip, { y: heights(tip, quantum, ends[1]) });
  fill(args.sample, { y: heights(surface, quantum, ends[0]) });

  const now = { time: time[index], height: height[index], force: force[index] };
  let count = 0;
  while (count < curve.data.time.length && curve.data.time[count] < now.time) count++;
  const past = {}, marked = {};
  for (const name of ["time", "height", "force"]) {
    past[name] = [...part(curve.data[name], 0, count), now[name]];
    marked[name] = [now[name]];
  }
  fill(args.past, past);
  fill(args.now, marked);
  args.reading.text = args.readings[index];
  args.slider.value = shown = index;
  window.softafm_movie_frames = (window.softafm_movie_frames ?? 0) + 1;
}

function advance(args, now) {
  if (last === null || args.stage.document === null) return;
  const count = args.readings.length;
  const rate = count / (1000 * args.seconds) * parseFloat(args.speed.value);
  place = (place + Math.max(0, now - last) * rate) % count;
  last = now;
  if (Math.floor(place) !== shown) show(args, Math.floor(place));
  requestAnimationFrame(later => advance(args, later));
}

function play(args, on) {
  const was = last !== null;
  last = on ? performance.now() : null;
  args.button.label = on ? "❚❚" : "▶";
  if (on && !was) requestAnimationFrame(now => advance(args, now));
}

// Gives the stage true proportions, whatever its size.
function fit({ stage, view }) {
  const { half_width, bottom, top, stretch } = view;
  const { inner_width, inner_height } = stage;
  if (!inner_width || !inner_height) return;
  const unit = Math.max((top - bottom) / inner_height, 2 * half_width / (inner_width * stretch));
  const across = unit * stretch * inner_width / 2, room = (unit * inner_height - top + bottom) / 2;
  const ends = [[stage.x_range, -across, across], [stage.y_range, bottom - room, top + room]];
  for (const [range, start, end] of ends)
    range.setv({ start, end, reset_start: start, reset_end: end });
}

export default (args, cause) => {
  const by = cause.origin ?? cause;
  if (by === args.button) {
    play(args, last === null);
    // With another label the button is a new one: a user who pressed Space wants to press it again.
    requestAnimationFrame(() => Bokeh.index.find_one(args.button)?.button_el?.focus());
  }
  else if (by === args.stage) fit(args);
  else if (by === args.slider && args.slider.value !== shown) {
    play(args, false);
    place = args.slider.value;
    show(args, place);
  }
};
