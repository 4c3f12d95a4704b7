// Panels, drawn from the server's list of controls (docs/WIRE.md): the words and keys are those of the window.
import { kBackgrounds } from './stage.js';

export function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  for (const [name, value] of Object.entries(properties)) if (name.includes('-')) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/// Of a table.
export const row = (...cells) => make('tr', {}, ...cells.map((cell) => make('td', {}, cell)));

const kIcons = {
  play: 'M7 4.5v15l12-7.5z',
  pause: 'M6 5h4v14H6zm8 0h4v14h-4z',
  step: 'M5 5v14l9-7zm11 0h3v14h-3z',
  start: 'M5 5h3v14H5zm14 0v14l-9-7z',
  help: 'M9.2 17.2h3.2v3.2H9.2zM11 3.4c3.4 0 6 1.9 6 5 0 2.3-1.2 3.4-2.7 4.4-1.3.9-1.9 1.500-1.9 2.7H9.3c0-2.400 1-3.500 2.600-4.600 1.2-.8 1.800-1.400 1.800-2.400 0-1.3-1.100-2.100-2.7-2.100-1.700 0-2.800.9-3 2.600L4.800 8.700C5.100 5.400 7.500 3.4 11 3.4z',
  ball: 'M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18zm0 2a7 7 0 0 1 6.3 4L12 11 5.7 9A7 7 0 0 1 12 5z',
  menu: 'M4 6h16v2.4H4zm0 5h16v2.4H4zm0 5h16v2.4H4z',
};
function icon(name) {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg'),
    path = document.createElementNS(svg.namespaceURI, 'path');
  svg.setAttribute('viewBox', '0 0 24 24');
  svg.setAttribute('aria-hidden', 'true');
  path.setAttribute('d', kIcons[name]);
  svg.append(path);
  return svg;
}

const kNotice = 5000; // how long a notice stays [ms]
const kOfPlain = ['hulls', 'colors']; // layers that are shown at first if an avatar has no materials of its own

export class Panel {
  state = null;
  controls = {}; // of the server's list, by id
  plain = true; // whether an avatar has no materials of its own
  choices = {
    layers: {}, // what the user chose of the controls that this page has for itself
    background: 'as the system',
    quality: 'automatic',
    presence: 'beside',
  };
  #fields = {};
  #made = {}; // elements of controls, by id
  #on;
  #lists = new Map();

  /// @param on  { set(id, values), choice(), act(id) }: changes for the server, of this page, and what a button does
  constructor(on) {
    this.#on = on;
    try {
      const kept = JSON.parse(localStorage.getItem('lorica') ?? '{}');
      for (const [name, value] of Object.entries(kept)) {
        if (name === 'layers') Object.assign(this.choices.layers, value);
        else if (name in this.choices) this.choices[name] = value;
      }
    } catch {
      /* damaged or forbidden: the usual choices */
    }
    this.#makePanel(document.getElementById('panel'));
    this.#makeBar(document.getElementById('bar'));
    document.getElementById('cancel').onclick = () => on.set('cancel');
  }

  /// As in the window, characters with materials of their own start without hulls and without the colours of parts.
  shows(layer) {
    return this.choices.layers[layer] ?? (kOfPlain.includes(layer) ? this.plain : layer !== 'bones');
  }

  /// Of what this page has for itself.
  toggle(id, on = !this.shows(id)) {
    this.choices.layers[id] = on;
    this.chose();
  }

  chose() {
    try {
      localStorage.setItem('lorica', JSON.stringify(this.choices));
    } catch {
      /* a private window may keep nothing */
    }
    for (const control of Object.values(this.controls)) if (control.own) this.#show(control);
    this.#on.choice();
  }

  #button(label, action, key, properties = {}) {
    const button = make(
      'button',
      { type: 'button', className: 'wide', onclick: () => this.#on.act(action), ...properties },
      label,
    );
    if (key) button.append(make('kbd', { 'aria-hidden': 'true' }, key));
    if (key) button.setAttribute('aria-keyshortcuts', key);
    return button;
  }

  #check(label, key, checked, change) {
    const box = make('input', { type: 'checkbox', checked, onchange: () => change(box.checked) });
    const shown = key ? [make('kbd', { 'aria-hidden': 'true' }, key)] : [];
    return [box, make('label', { className: 'check' }, box, label, ...shown)];
  }

  #select(label, change) {
    const select = make('select', { onchange: () => change(select.value) });
    return [select, make('label', { className: 'field' }, make('span', {}, label), select)];
  }

  /// The elements of a control. @return { row, and its input or button }
  #make(control) {
    const { id, kind, label } = control,
      keys = control.keys ?? '';
    const change = (to) => (control.own ? this.toggle(id, to) : this.#on.set(id, { to }));
    if (kind === 'toggle') {
      const [input, row] = this.#check(label, keys, false, change);
      return { row, input };
    }
    if (kind === 'button') {
      const row = this.#button(label, id, keys, id === 'throw' ? { className: 'wide strong' } : {});
      return { row, input: row };
    }
    if (kind === 'number') {
      const name = make('span'),
        input = make('input', { type: 'range', step: 1, onchange: () => change(Number(input.value)) });
      input.oninput = () => (name.textContent = `${input.value} ${label}`);
      return { row: make('label', { className: 'field' }, name, input), input, name };
    }
    const [input, row] = this.#select(label, (value) => {
      change(Number(value));
      if (kind === 'files') input.value = String(this.controls[id].value); // until it is open
    });
    return { row, input };
  }

  /// Shows what a control is now.
  #show(control) {
    const made = this.#made[control.id];
    if (!made) return;
    const { id, kind, label, no = '', least = 0, most = 0 } = control,
      { row, input, name } = made,
      value = control.own ? this.shows(id) : control.value;
    row.hidden = Boolean(control.absent);
    input.disabled = Boolean(no);
    row.title = no;
    if (kind === 'toggle') input.checked = value;
    else if (kind === 'button' && !control.own) {
      input.firstChild.data = label;
      input.setAttribute('aria-pressed', Boolean(value));
    } else if (kind === 'number') {
      if (document.activeElement !== input) Object.assign(input, { min: least, max: most, value });
      name.textContent = `${value} ${label}`;
    } else if (kind === 'list' || kind === 'files') {
      const options = control.choices.map((choice, i) => [i, choice]);
      if (least < 0 || value < 0) options.unshift([-1, control.none]);
      this.#fill(input, id, options, ([i, text]) => make('option', { value: i, disabled: i < least }, text));
      input.value = String(Math.max(value, -1));
    }
  }

  /// The server's list of controls: each gets its element once.
  set(list) {
    this.controls = Object.fromEntries(list.map((control) => [control.id, control]));
    for (const control of list) {
      const { things, look, grid } = this.#fields;
      if (control.group === 'things' || control.group === 'look') {
        if (!this.#made[control.id]) {
          const made = (this.#made[control.id] = this.#make(control));
          const small = control.kind === 'toggle' && control.label.length < 12;
          (control.group === 'things' ? things : small ? grid : look).append(made.row);
        }
        this.#show(control);
      }
    }
    const f = this.#fields,
      { pause, restart, seek, speed, throw: ball } = this.controls;
    f.start.hidden = Boolean(restart.absent);
    f.timeline.hidden = f.speeds.hidden = Boolean(seek.absent);
    f.timeline.max = seek.most ?? 0;
    f.ball.disabled = Boolean(ball.no);
    f.ball.title = ball.no || 'Throw a ball (B)';
    this.#fill(f.speeds, 'speeds', speed.choices, (name) => {
      const to = speed.choices.indexOf(name);
      return make('button', { type: 'button', onclick: () => this.#on.set('speed', { to }), 'aria-label': `Speed ${name}` }, name);
    });
    [...f.speeds.children].forEach((button, i) => button.setAttribute('aria-pressed', i === speed.value));
    this.#showPause(pause.value);
  }

  #showPause(paused = this.controls.pause?.value) {
    const f = this.#fields,
      shown = Boolean(paused || this.state?.ended);
    if (f.pause.shows === shown) return;
    f.pause.shows = shown;
    f.pause.replaceChildren(icon(shown ? 'play' : 'pause'));
    f.pause.setAttribute('aria-label', shown ? 'Play' : 'Pause');
    f.pause.title = `${shown ? 'Play' : 'Pause'} (space)`;
  }

  #makePanel(panel) {
    const f = this.#fields,
      section = (title, open, ...children) => make('details', { open }, make('summary', {}, title), ...children);
    f.things = make('div');
    f.grid = make('div', { className: 'grid' });
    f.look = make('div');
    f.hits = make('table', { 'aria-label': 'Hits of the targets' });
    f.licence = make('p', { className: 'faint' });
    f.watched = make(
      'p',
      { className: 'faint', hidden: true },
      'A recorded session: nothing can be thrown or dragged.',
    );
    const choose = (name, options, label = name) => {
      const [select, row] = this.#select(label, (value) => {
        this.choices[name] = value;
        this.chose();
      });
      for (const [value, text = value] of options.map((option) => [option].flat()))
        select.append(make('option', { value, selected: value === this.choices[name] }, text));
      return row;
    };
    const sides = make(
      'div',
      { className: 'choices', role: 'group', 'aria-label': 'Look from' },
      ...['front', 'left', 'right', 'back', 'above'].map((side) => this.#button(side, side, '', { className: '' })),
    );
    const presences = [
      ['beside', 'stand beside the avatar'],
      ['inside', 'be the avatar'],
    ];
    f.vr = this.#button('Enter VR', 'vr', '', { className: 'wide strong' });
    f.ar = this.#button('Enter AR', 'ar', '');
    f.xr = make('p', { className: 'faint' }, 'Looking for a headset ...');
    f.xrRows = make('div', {}, choose('presence', presences, 'in VR'), f.vr, f.ar);
    f.times = make('table');
    const handle = make(
      'div',
      { className: 'handle' },
      'Settings',
      this.#button('close', 'panel', '', { className: '' }),
    );
    let from = null; // of the sheet that is pulled down on a phone
    handle.onpointerdown = ({ clientY }) => {
      from = clientY;
    };
    handle.onpointermove = ({ clientY }) => {
      if (from !== null && clientY > from + 40) {
        from = null;
        this.#on.act('panel');
      }
    };
    handle.onpointerup = handle.onpointerleave = () => {
      from = null;
    };
    panel.append(
      handle,
      section('Who and what', true, f.things, f.hits, f.watched, f.licence),
      section(
        'Look',
        true,
        f.grid,
        sides,
        f.look,
        choose('background', ['as the system', ...Object.keys(kBackgrounds)]),
        choose('quality', ['automatic', 'high', 'medium', 'low']),
      ),
      section('VR and AR', false, f.xrRows, f.xr),
      section('Numbers', false, f.times),
      make('p', { className: 'faint' }, make('a', { href: 'licences.txt', target: '_blank' }, 'Licences')),
    );
    if (matchMedia('(max-width: 720px), (max-height: 500px)').matches) document.body.classList.add('shut');
  }

  #makeBar(bar) {
    const f = this.#fields,
      action = (label, name, key, ...image) =>
        make(
          'button',
          {
            type: 'button',
            className: 'icon',
            title: `${label} (${key})`,
            'aria-label': label,
            'aria-keyshortcuts': key,
            onclick: () => this.#on.act(name),
          },
          ...image.map(icon),
        );
    f.pause = action('Pause', 'pause', 'Space');
    f.step = action('Step', 'step', 'N', 'step');
    f.start = action('Start', 'restart', 'Home', 'start');
    f.timeline = make('input', {
      type: 'range',
      className: 'timeline',
      min: 0,
      step: 0.01,
      'aria-label': 'Time',
      onchange: () => this.#on.set('seek', { to: Number(f.timeline.value) }),
      oninput: () => this.#showTime(Number(f.timeline.value)),
    });
    const hold = (held) => () => {
      f.timeline.held = held;
    };
    f.timeline.onpointerdown = hold(true);
    f.timeline.onpointerup = f.timeline.onpointercancel = f.timeline.onblur = hold(false);
    f.time = make('span', { className: 'time' });
    f.speeds = make('div', { className: 'choices speeds', role: 'group', 'aria-label': 'Speed' });
    f.title = make('span', { className: 'title' });
    f.status = make('span', { className: 'status' });
    f.ball = action('Throw a ball', 'throw', 'B', 'ball');
    const menu = action('Settings', 'panel', 'M', 'menu');
    menu.setAttribute('aria-expanded', String(!document.body.classList.contains('shut')));
    this.menu = menu;
    const help = action('Help', 'help', 'H', 'help');
    help.classList.add('help');
    bar.append(
      make(
        'div',
        { className: 'row' },
        f.pause,
        f.step,
        f.start,
        f.timeline,
        f.time,
        f.speeds,
        make('span', { className: 'spread' }),
        f.ball,
        help,
        menu,
      ),
      make('div', { className: 'row line' }, f.title, f.status),
    );
    f.speeds.hidden = f.timeline.hidden = true;
  }

  #showTime(seconds) {
    const { state } = this;
    this.#fields.time.textContent =
      state.duration > 0 ? `${seconds.toFixed(1)} of ${state.duration.toFixed(1)} s` : `${seconds.toFixed(1)} s`;
    this.#fields.timeline.setAttribute('aria-valuetext', this.#fields.time.textContent);
  }

  /// Writes into a list only if it is another than before.
  #fill(container, key, items, row) {
    const text = JSON.stringify(items);
    if (this.#lists.get(key) === text) return;
    this.#lists.set(key, text);
    container.replaceChildren(...items.map(row));
  }

  update(state, hello) {
    this.state = state;
    document.body.classList.remove('waiting');
    const f = this.#fields;
    f.watched.hidden = !hello?.watched;
    const shared = location.protocol === 'https:'; // by --lan; else nobody but this machine gets it
    const licences = (hello?.avatars ?? []).filter((avatar) => avatar.licence).map((avatar) => `${avatar.name}: ${avatar.licence}`);
    f.licence.textContent = shared ? [...new Set(licences)].join(' ') : '';
    this.#fill(f.hits, 'hits', state.hits ?? [], ({ name, hits }) => row(name, hits));
    this.#showPause();
    if (!f.timeline.held) {
      f.timeline.value = state.seconds;
      this.#showTime(state.seconds);
    }
    f.title.textContent = state.title;
    f.status.textContent = [
      state.status,
      state.outside ? 'outside the range of the hulls' : '',
      state.recording ? `recording ${state.recording}` : '',
      state.clients > 1 ? `${state.clients} watch` : '',
    ]
      .filter(Boolean)
      .join('   ');
    document.title = state.title ? `${state.title} - Lorica` : 'Lorica';
    this.#fill(document.getElementById('warnings'), 'warnings', state.warnings ?? [], (text) => make('li', {}, text));
    const loading = document.getElementById('loading');
    loading.hidden = !state.loading;
    loading.firstChild.textContent = state.loading;
    loading.children[1].value = state.loaded ?? 0;
  }

  video(runs) {
    const { row } = this.#made.video;
    row.firstChild.data = runs ? 'stop the video' : 'start a video';
    row.setAttribute('aria-pressed', runs);
  }

  numbers(rows) {
    const { times } = this.#fields,
      stages = (this.state?.times ?? []).map(([stage, ms]) => [stage, `${ms.toFixed(2)} ms`]);
    if (times.closest('details').open)
      this.#fill(times, 'times', [...rows, ...stages], ([name, value]) => row(name, value));
  }

  xr({ vr, ar, sentence }) {
    const f = this.#fields;
    f.vr.hidden = !vr;
    f.ar.hidden = !ar;
    f.xrRows.hidden = !vr && !ar;
    f.xr.textContent = sentence;
    if (vr || ar) f.xr.closest('details').open = true;
  }

  notice(text, problem = false) {
    const list = document.getElementById('notices');
    const item = make('li', { className: problem ? 'problem' : '', role: problem ? 'alert' : 'status' }, text);
    list.append(item);
    while (list.children.length > 3) list.firstChild.remove();
    setTimeout(() => item.remove(), problem ? 3 * kNotice : kNotice);
  }

  /// A notice until it is removed.
  busy(text) {
    const item = make('li', { role: 'status' }, text);
    document.getElementById('notices').append(item);
    return item;
  }

  /// What panels cover at the right and at the bottom [CSS pixels].
  covered() {
    const sheet = document.getElementById('panel').getBoundingClientRect(),
      bar = document.getElementById('bar').getBoundingClientRect();
    const narrow = matchMedia('(max-width: 720px)').matches;
    return {
      right: narrow || sheet.width === 0 ? 0 : sheet.width + 12,
      bottom: narrow && sheet.height > 0 ? sheet.height : bar.height > 0 ? innerHeight - bar.top : 0,
    };
  }
}
