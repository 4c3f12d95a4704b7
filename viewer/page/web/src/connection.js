// The WebSocket of docs/WIRE.md: it connects again by itself and never sends more than the server takes.
const kAckPause = 15; // shortest time between acknowledgements [ms]; with drags below the server's 180 messages a second
const kDragPause = 30;
const kLargestFile = 64 * 2 ** 20; // that the server takes [bytes]

/// Sentences for the user, by what happened.
const kSays = {
  first: 'Connecting ...',
  lost: 'The connection is lost. Connecting again ...',
  over: 'The session is over. This page continues when another one starts.',
  refused: 'This link is not or no longer valid. Please use the one that the program shows now.',
  large: 'it has more than 64 MiB: open it on the machine that serves',
  unsent: 'the connection was lost before all of it was sent',
  broken: 'The server closed the connection',
};

export class Connection {
  token = decodeURIComponent(location.hash.slice(1));
  open = false;
  received = 0; // bytes
  #socket = null;
  #tries = 0;
  #acked = 0;
  #ackAt = 0;
  #dragAt = 0;
  #drags = [null, null]; // of each hand, not sent yet
  #on;

  /// @param on  { opened(), message(object), frame(ArrayBuffer), says(sentence or '', whether to give up) }
  constructor(on) {
    this.#on = on;
    on.says(kSays.first, false);
    this.#connect();
    addEventListener('hashchange', () => {
      location.reload();
    });
  }

  #connect() {
    const protocols = ['lorica.live.1', ...(this.token ? [`token.${this.token}`] : [])];
    let socket;
    try {
      socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/live`, protocols);
    } catch {
      return this.#on.says(kSays.refused, true); // a token that cannot be a subprotocol
    }
    this.#socket = socket;
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.open = true;
      this.#tries = this.#acked = 0;
      this.#on.says('', false);
      this.#on.opened();
    };
    socket.onmessage = ({ data }) => {
      this.received += data.byteLength ?? data.length;
      if (typeof data === 'string') this.#on.message(JSON.parse(data));
      else this.#on.frame(data);
    };
    socket.onclose = ({ code, reason }) => this.#closed(code, reason);
  }

  async #closed(code, reason) {
    const wasOpen = this.open;
    this.open = false;
    this.#drags.fill(null);
    let wait = Math.min(500 * 1.6 ** this.#tries++, 5000);
    if (wasOpen && (code === 1000 || code === 1001)) {
      this.#on.says(kSays.over, false);
      this.#tries = 5;
      wait = 2000;
    } else if (wasOpen && code !== 1006) {
      this.#on.says(`${kSays.broken}${reason ? `: ${reason}` : ''}. Connecting again ...`, false);
    } else if (wasOpen) {
      this.#on.says(kSays.lost, false);
    } else if (await this.#refused()) {
      return this.#on.says(kSays.refused, true);
    } else if (this.#tries === 2) {
      this.#on.says(kSays.lost, false);
    }
    setTimeout(() => this.#connect(), wait);
  }

  /// A WebSocket does not say why it did not open; HTTP does.
  async #refused() {
    try {
      return (await fetch('/character/0.glb', { method: 'HEAD', headers: this.#headers() })).status === 401;
    } catch {
      return false;
    }
  }

  #headers = () => (this.token ? { Authorization: `Bearer ${this.token}` } : {});

  /// @throws with a sentence
  fetchBytes = async (path) => {
    const answer = await fetch(path, { headers: this.#headers() });
    if (!answer.ok) throw new Error(`${path} cannot be read (${answer.status})`);
    return answer.arrayBuffer();
  };

  /// Sends a file that is to be opened. @return why that cannot be, as a sentence; empty = it is being opened
  sendFile = async (file) => {
    if (file.size > kLargestFile) return kSays.large;
    const ending = file.name.split('.').at(-1).toLowerCase();
    try {
      const answer = await fetch(`/open/${encodeURIComponent(ending)}`, {
        method: 'PUT',
        headers: this.#headers(),
        body: file,
      });
      return answer.ok ? '' : (await answer.text()).trim();
    } catch {
      return kSays.unsent;
    }
  };

  send(type, values = {}) {
    if (type === 'release') this.#flush();
    this.#write({ type, ...values });
  }

  /// Changes a control. @param values  { to } the new value, or { by } steps on from the present one
  set(id, values = {}) {
    this.#write({ set: id, ...values });
  }

  #write(message) {
    if (this.open) this.#socket.send(JSON.stringify(message));
  }

  /// The newest place of what a hand holds; not each one is sent.
  drag(ray, hand = 0) {
    this.#drags[hand] = ray;
    if (performance.now() - this.#dragAt >= kDragPause) this.#flush();
  }

  #flush() {
    this.#drags.forEach((ray, hand) => {
      if (!ray) return;
      this.#drags[hand] = null;
      this.#dragAt = performance.now();
      this.send('drag', { hand, ...ray });
    });
  }

  /// Once a picture: everything up to this frame is drawn.
  drawn(number) {
    const now = performance.now();
    if (now - this.#dragAt >= kDragPause) this.#flush();
    if (number <= this.#acked || now - this.#ackAt < kAckPause) return;
    this.#acked = number;
    this.#ackAt = now;
    this.send('ack', { frame: number });
  }
}
