// Panels, made from tables. The words and keys are those of the window (docs/WINDOW.md).
import { kBackgrounds } from './stage.js';

export function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  for (const [name, value] of Object.entries(properties)) if (name.includes('-')) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

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

/// [list of the state, its index, message, label, what -1 is called, whether it can be chosen]
const kLists = [
  ['characters', 'character', 'character', 'avatar'],
  ['motions', 'motion', 'motion', 'motion'],
  ['clips', 'clip', 'clip', 'clip'],
  ['people', 'person', 'person', 'person', 'everyone'],
  ['expressions', 'expression', 'expression', 'expression', 'none', true],
  ['scenes', 'scene', 'scene', 'scene'],
  ['recents', '', 'recent', 'recent files', 'open again ...'],
];
const kTreatments = [
  ['smoothings', 'smoothing', 'as given'],
  ['gravities', 'gravity'],
];
export const kLayers = {
  character: ['1', 'character'],
  hulls: ['2', 'hulls'],
  bones: ['3', 'bones'],
  props: ['4', 'props'],
  contacts: ['5', 'contacts'],
  ground: ['6', 'ground'],
  particles: ['7', 'grains'],
  depth: ['8', 'depth'],
};
const kSpeedNames = { 0.25: '1/4', 0.5: '1/2' };
const kNotice = 5000; // how long a notice stays [ms]

export class Panel {
  state = null;
  plain = true; // whether an avatar has no materials of its own
  choices = {
    layers: {
      character: true,
      hulls: null,
      bones: false,
      props: true,
      contacts: true,
      ground: true,
      particles: true,
      depth: true,
    },
    background: 'as the system',
    quality: 'automatic',
    parts: null, // colours by part
    follow: true,
    presence: 'beside',
  };
  #fields = {};
  #on;
  #lists = new Map();

  /// @param on  { send(type, values), choice(), run(action) }: wishes, changed choices of this page, actions of the table of keys
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
    document.getElementById('cancel').onclick = () => on.send('cancel');
  }

  /// As in the window, characters with materials of their own start without hulls.
  shows(layer) {
    return this.choices.layers[layer] ?? this.plain;
  }

  /// As in the window, other characters start with the colours of their parts.
  colorsByParts() {
    return this.choices.parts ?? this.plain;
  }

  chose() {
    try {
      localStorage.setItem('lorica', JSON.stringify(this.choices));
    } catch {
      /* a private window may keep nothing */
    }
    for (const [name, box] of Object.entries(this.#fields.layers)) box.checked = this.shows(name);
    this.#fields.follow.checked = this.choices.follow;
    this.#fields.colors.checked = this.colorsByParts();
    this.#on.choice();
  }

  #button(label, action, key, properties = {}) {
    const button = make(
      'button',
      { type: 'button', className: 'wide', onclick: () => this.#on.run(action), ...properties },
      label,
    );
    if (key) button.append(make('kbd', { 'aria-hidden': 'true' }, key));
    if (key) button.setAttribute('aria-keyshortcuts', key);
    return button;
  }

  #check(label, key, checked, change) {
    const box = make('input', { type: 'checkbox', checked, onchange: () => change(box.checked) });
    return [
      box,
      make('label', { className: 'check' }, box, label, ...(key ? [make('kbd', { 'aria-hidden': 'true' }, key)] : [])),
    ];
  }

  #select(label, change) {
    const select = make('select', { onchange: () => change(select.selectedIndex, select.value) });
    return [select, make('label', { className: 'field' }, make('span', {}, label), select)];
  }

  #makePanel(panel) {
    const f = this.#fields,
      section = (title, open, ...children) => make('details', { open }, make('summary', {}, title), ...children);
    const who = kLists.map(([list, , type, label, none, choosable]) => {
      const [select, row] = this.#select(label, (_, value) => this.#on.send(type, { index: Number(value) }));
      f[list] = { select, row, none, choosable };
      return row;
    });
    const [mirror, mirrorRow] = this.#check('mirror', '', false, (on) => this.#on.send('mirror', { on }));
    const treatments = kTreatments.map(([list, type, none]) => {
      const [select, row] = this.#select(type, (_, value) => this.#on.send(type, { index: Number(value) }));
      f[list] = { select, row, none };
      return row;
    });
    const [loop, loopRow] = this.#check('start again at the end', 'L', true, (on) => this.#on.send('loop', { on }));
    f.open = this.#button('open a file ...', 'open', 'O');
    f.throw = this.#button('throw a ball', 'ball', 'B', { className: 'wide strong' });
    f.undo = this.#button('undo', 'undo', 'U');
    f.record = this.#button('record from the start', 'record', '');
    f.hits = make('table', { 'aria-label': 'Hits of the targets' });
    f.licence = make('p', { className: 'faint' });
    f.watched = make(
      'p',
      { className: 'faint', hidden: true },
      'A recorded session: nothing can be thrown or dragged.',
    );
    Object.assign(f, { mirror, mirrorRow, loop, loopRow, layers: {} });
    const layers = make(
      'div',
      { className: 'grid' },
      ...Object.entries(kLayers).map(([name, [key, label]]) => {
        const [box, row] = this.#check(label, key, this.shows(name), (on) => {
          this.choices.layers[name] = on;
          this.chose();
        });
        f.layers[name] = box;
        return row;
      }),
    );
    const [follow, followRow] = this.#check('follow with the camera', 'F', this.choices.follow, (on) => {
      this.choices.follow = on;
      this.chose();
    });
    f.follow = follow;
    const [colors, colorsRow] = this.#check('colours by part', 'C', this.colorsByParts(), (on) => {
      this.choices.parts = on;
      this.chose();
    });
    f.colors = colors;
    f.video = this.#button('start a video', 'video', 'V');
    f.parts = make('input', {
      type: 'range',
      min: 1,
      step: 1,
      oninput: () => {
        f.partsName.textContent = `${f.parts.value} parts`;
      },
      onchange: () => this.#on.send('parts', { count: Number(f.parts.value) }),
    });
    f.partsName = make('span');
    f.partsRow = make('label', { className: 'field' }, f.partsName, f.parts);
    const choose = (name, options) => {
      const [select, row] = this.#select(name, (_, value) => {
        this.choices[name] = value;
        this.chose();
      });
      select.append(
        ...options.map((option) => make('option', { value: option, selected: option === this.choices[name] }, option)),
      );
      return row;
    };
    const sides = make(
      'div',
      { className: 'choices', role: 'group', 'aria-label': 'Look from' },
      ...['front', 'left', 'right', 'back', 'above'].map((side) => this.#button(side, side, '', { className: '' })),
    );
    const [presence, presenceRow] = this.#select('in VR', (_, value) => {
      this.choices.presence = value;
      this.chose();
    });
    presence.append(
      ...[
        ['beside', 'stand beside the avatar'],
        ['inside', 'be the avatar'],
      ].map(([value, text]) => make('option', { value, selected: value === this.choices.presence }, text)),
    );
    f.vr = this.#button('Enter VR', 'vr', '', { className: 'wide strong' });
    f.ar = this.#button('Enter AR', 'ar', '');
    f.xr = make('p', { className: 'faint' }, 'Looking for a headset ...');
    f.xrRows = make('div', {}, presenceRow, f.vr, f.ar);
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
        this.#on.run('panel');
      }
    };
    handle.onpointerup = handle.onpointerleave = () => {
      from = null;
    };
    panel.append(
      handle,
      section(
        'Who and what',
        true,
        ...who,
        f.open,
        mirrorRow,
        ...treatments,
        loopRow,
        f.throw,
        f.undo,
        f.record,
        f.hits,
        f.watched,
        f.licence,
      ),
      section(
        'Look',
        true,
        layers,
        colorsRow,
        followRow,
        sides,
        f.partsRow,
        choose('background', ['as the system', ...Object.keys(kBackgrounds)]),
        choose('quality', ['automatic', 'high', 'medium', 'low']),
        this.#button('save a picture', 'picture', 'P'),
        f.video,
      ),
      section('VR and AR', false, f.xrRows, f.xr),
      section('Numbers', false, f.times),
      make('p', { className: 'faint' }, make('a', { href: 'licences.txt', target: '_blank' }, 'Licences')),
    );
    if (matchMedia('(max-width: 720px), (max-height: 500px)').matches) document.body.classList.add('shut');
  }

  #makeBar(bar) {
    const f = this.#fields,
      action = (label, name, key) => {
        const button = make('button', {
          type: 'button',
          className: 'icon',
          title: `${label} (${key})`,
          'aria-label': label,
          'aria-keyshortcuts': key,
          onclick: () => this.#on.run(name),
        });
        return button;
      };
    f.pause = action('Pause', 'pause', 'Space');
    f.step = action('Step', 'step', 'N');
    f.start = action('Start', 'restart', 'Home');
    f.timeline = make('input', {
      type: 'range',
      className: 'timeline',
      min: 0,
      step: 0.01,
      'aria-label': 'Time',
      onchange: () => this.#on.send('seek', { to: Number(f.timeline.value) }),
      oninput: () => this.#showTime(Number(f.timeline.value)),
    });
    f.timeline.onpointerdown = () => {
      f.timeline.held = true;
    };
    f.timeline.onpointerup =
      f.timeline.onpointercancel =
      f.timeline.onblur =
        () => {
          f.timeline.held = false;
        };
    f.time = make('span', { className: 'time' });
    f.speeds = make('div', { className: 'choices speeds', role: 'group', 'aria-label': 'Speed' });
    f.title = make('span', { className: 'title' });
    f.status = make('span', { className: 'status' });
    f.ball = action('Throw a ball', 'ball', 'B');
    const menu = action('Settings', 'panel', 'M');
    menu.setAttribute('aria-expanded', String(!document.body.classList.contains('shut')));
    this.menu = menu;
    const help = action('Help', 'help', 'H');
    help.classList.add('help');
    for (const [button, name] of [
      [f.step, 'step'],
      [f.start, 'start'],
      [f.ball, 'ball'],
      [help, 'help'],
      [menu, 'menu'],
    ])
      button.append(icon(name));
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

  #list({ select, row, none, choosable }, key, names = [], index = -1) {
    row.hidden = names.length === 0;
    const unlisted = choosable || index < 0 ? [[-1, none ?? 'another']] : [];
    const options = [...unlisted, ...names.map((name, i) => [i, name])];
    const option = ([value, name]) => make('option', { value, disabled: value < 0 && !choosable }, name);
    this.#fill(select, key, options, option);
    if (select.value !== String(index)) select.value = String(index);
  }

  update(state, hello) {
    this.state = state;
    document.body.classList.remove('waiting');
    const f = this.#fields,
      can = (element, why) => {
        element.disabled = Boolean(why);
        (element.closest('label') ?? element).title = why ?? '';
      };
    const watched = Boolean(hello?.watched),
      no = state.no ?? {};
    for (const [list, index] of kLists) {
      this.#list(f[list], list, state[list], state[index]);
      f[list].select.disabled = watched;
    }
    for (const [list, index] of kTreatments) {
      this.#list(f[list], list, state[list], state[index]);
      can(f[list].select, no[index]);
    }
    for (const name of ['mirror', 'loop']) {
      f[name].checked = state[name];
      can(f[name], no[name]);
    }
    f.loopRow.hidden = !(state.duration > 0);
    for (const button of [f.throw, f.ball]) can(button, no.throw);
    can(f.undo, no.undo);
    can(f.record, no.record);
    can(f.open, no.open);
    f.record.firstChild.data = state.recording ? 'end the recording' : 'record from the start';
    f.record.setAttribute('aria-pressed', Boolean(state.recording));
    f.watched.hidden = !watched;
    const licences = [...new Set((hello?.avatars ?? []).map((avatar) => avatar.licence).filter(Boolean))];
    f.licence.textContent = licences.join(' ');
    this.#fill(f.hits, 'hits', state.hits ?? [], ({ name, hits }) =>
      make('tr', {}, make('td', {}, name), make('td', {}, hits)),
    );
    f.partsRow.hidden = !state.maxParts;
    if (document.activeElement !== f.parts) Object.assign(f.parts, { max: state.maxParts, value: state.parts });
    f.partsName.textContent = `${state.parts} parts`;

    const paused = state.paused || state.ended;
    if (f.pause.shows !== paused) {
      f.pause.shows = paused;
      f.pause.replaceChildren(icon(paused ? 'play' : 'pause'));
      f.pause.setAttribute('aria-label', paused ? 'Play' : 'Pause');
      f.pause.title = `${paused ? 'Play' : 'Pause'} (space)`;
    }
    const recorded = state.duration > 0;
    f.start.hidden = f.timeline.hidden = f.speeds.hidden = !recorded;
    f.timeline.max = state.duration;
    if (!f.timeline.held) {
      f.timeline.value = state.seconds;
      this.#showTime(state.seconds);
    }
    this.#fill(f.speeds, 'speeds', state.speeds ?? [], (speed) =>
      Object.assign(
        make(
          'button',
          {
            type: 'button',
            onclick: () => this.#on.send('speed', { to: speed }),
            'aria-label': `Speed ${kSpeedNames[speed] ?? speed}`,
          },
          kSpeedNames[speed] ?? `${speed}`,
        ),
        { speed },
      ),
    );
    for (const button of f.speeds.children) button.setAttribute('aria-pressed', button.speed === state.speed);
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
    this.#fields.video.firstChild.data = runs ? 'stop the video' : 'start a video';
    this.#fields.video.setAttribute('aria-pressed', runs);
  }

  numbers(rows) {
    if (this.#fields.times.closest('details').open)
      this.#fill(
        this.#fields.times,
        'times',
        [...rows, ...(this.state?.times ?? []).map(([stage, ms]) => [stage, `${ms.toFixed(2)} ms`])],
        ([name, value]) => make('tr', {}, make('td', {}, name), make('td', {}, value)),
      );
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
      bottom: narrow && sheet.height > 0 ? sheet.height : innerHeight - bar.top,
    };
  }
}
