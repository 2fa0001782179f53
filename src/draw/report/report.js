"use strict";
(() => {
  const element = (id) => document.getElementById(id);
  const { charts, film } = JSON.parse(element("data").textContent);
  const number = (value) => Number(value.toPrecision(4)).toString().replace("-", "\u2212");

  // Plots: a line and the values at the pointer's time.
  const times = [];
  document.querySelectorAll(".chart").forEach((figure, n) => {
    const { x, y, values, places, curves } = charts[n];
    const unit = / \((.*)\)$/.exec(y)?.[1] ?? "";
    const svg = figure.querySelector("svg");
    const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
    line.setAttribute("y1", places[1][1]);
    line.setAttribute("y2", places[1][0]);
    line.setAttribute("stroke", "#666");
    line.setAttribute("stroke-width", "0.8");
    line.setAttribute("visibility", "hidden");
    svg.append(line);
    const [from, to] = values[0];
    const [left, right] = places[0];
    const show = (time) => {
      const within = time >= from && time <= to;
      line.setAttribute("visibility", within ? "visible" : "hidden");
      if (!within) return;
      const at = left + ((time - from) / (to - from)) * (right - left);
      line.setAttribute("x1", at);
      line.setAttribute("x2", at);
      const read = curves.map(({ label, points }) => {
        const known = points.filter(([t, v]) => t !== null && v !== null);
        if (known.length === 0) return null;
        const near = known.reduce((a, b) =>
          Math.abs(b[0] - time) < Math.abs(a[0] - time) ? b : a);
        if (Math.abs(near[0] - time) > 0.05 * (to - from)) return null;
        return `${label} ${number(near[1])} ${unit}`.trimEnd();
      });
      const name = x.replace(/ \(.*/, "");
      figure.querySelector(".read").textContent =
        `${name} ${number(time)} ms: ` + read.filter((text) => text).join(", ");
    };
    times.push(show);
    const pointed = (event) => {
      const box = svg.getBoundingClientRect();
      const at = ((event.clientX - box.left) / box.width) * svg.viewBox.baseVal.width;
      const time = from + ((at - left) / (right - left)) * (to - from);
      if (time < from || time > to) return;
      times.forEach((show) => show(time));
      if (event.buttons || event.type === "pointerdown") jump(time);
    };
    svg.addEventListener("pointermove", pointed);
    svg.addEventListener("pointerdown", pointed);
  });

  // The table of results, for a spreadsheet.
  const copy = element("copy");
  copy.hidden = false;
  copy.addEventListener("click", async () => {
    const rows = [...element("results").rows];
    const text = rows.map((row) => [...row.cells].map((c) => c.textContent).join("\t")).join("\n");
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      const area = document.body.appendChild(document.createElement("textarea"));
      area.value = text;
      area.select();
      document.execCommand("copy");
      area.remove();
    }
    copy.textContent = "Copied";
    setTimeout(() => { copy.textContent = "Copy"; }, 1500);
  });

  // The player.
  let jump = () => {};
  const canvas = document.querySelector("#player canvas");
  const gl = canvas && canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
  if (!gl || !film || !window.DecompressionStream) return;

  const unpack = async ({ data, points, faces }) => {
    const packed = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    const axes = film.kind === "mesh" ? 3 : 2;
    const corners = { mesh: 3, outline: 2, points: 0 }[film.kind];
    let at = 0;
    const column = (count, width, out, start, step) => {
      let sum = 0;
      for (let i = 0; i < count; i++) {
        let value = 0;
        for (let byte = 0; byte < width; byte++) value += bytes[at + byte * count + i] * 256 ** byte;
        sum = (sum + value) % 256 ** width;
        out[start + step * i] = sum;
      }
      at += width * count;
      return out;
    };
    const place = new Uint16Array(axes * points);
    const normal = new Uint8Array(axes * points);
    for (let a = 0; a < axes; a++) column(points, 2, place, a, axes);
    if (corners) for (let a = 0; a < axes; a++) column(points, 1, normal, a, axes);
    const tone = new Uint8Array(3 * points);
    if (!corners) {
      const body = column(points, 1, new Uint8Array(points), 0, 1);
      body.forEach((body, i) => tone.set(film.tints[body], 3 * i));
    }
    const face = column(faces * corners, 4, new Uint32Array(faces * corners), 0, 1);
    return { place, normal, tone, face };
  };

  const head = "#version 300 es\nprecision highp float;";
  const seen = "uniform mat4 view; uniform vec3 low, size; out vec3 at, normal;";
  const vertex = {
    mesh: `${head}${seen} in vec3 place, side;
      void main() { at = low + size * place; normal = side * 255. / 127. - 1.;
        gl_Position = view * vec4(at, 1.); }`,
    outline: `${head}${seen} in vec4 place, side; uniform vec2 axis; uniform float sectors;
      void main() { bool end = (gl_VertexID & 1) == 1;
        vec2 p = low.xz + size.xz * (end ? place.zw : place.xy);
        vec2 n = (end ? side.zw : side.xy) * 255. / 127. - 1.;
        float turn = 6.28318530718 * float(gl_VertexID >> 1) / sectors;
        vec2 out_ = vec2(cos(turn), sin(turn));
        at = vec3(axis + p.x * out_, p.y); normal = vec3(n.x * out_, n.y);
        gl_Position = view * vec4(at, 1.); }`,
    points: `${head}${seen} in vec2 place; in vec3 tone; out vec3 own; uniform float dot_;
      void main() { at = vec3(low.x + size.x * place.x, 0., low.z + size.z * place.y); own = tone;
        normal = vec3(0., -1., 0.); gl_Position = view * vec4(at, 1.); gl_PointSize = dot_; }`,
  };
  const fragment = `${head} in vec3 at, normal; uniform vec3 eye, tint; uniform float flat_;
    out vec4 colour;
    vec3 sky(vec3 d) { return mix(vec3(.50, .56, .62), vec3(.93, .96, 1.), smoothstep(-.3, .8, d.z)); }
    void main() {
      if (flat_ > 0.) { colour = vec4(tint, 1.); return; }
      vec3 n = normalize(normal), e = normalize(eye - at);
      if (dot(n, e) < 0.) n = -n;
      vec3 light = normalize(vec3(-.4, -.5, .9));
      float shine = .04 + .96 * pow(1. - max(dot(n, e), 0.), 5.);
      vec3 body = tint * (.35 + .75 * max(dot(n, light), 0.) + .15 * n.z);
      vec3 seen = mix(body, sky(reflect(-e, n)), shine);
      seen += .55 * pow(max(dot(reflect(-light, n), e), 0.), 60.);
      colour = vec4(seen, 1.);
    }`;
  const round = `${head} in vec3 own; out vec4 colour;
    void main() { if (length(gl_PointCoord - .5) > .5) discard; colour = vec4(own, 1.); }`;
  const program = (source, look) => {
    const made = gl.createProgram();
    [[gl.VERTEX_SHADER, source], [gl.FRAGMENT_SHADER, look]].forEach(([type, text]) => {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw gl.getShaderInfoLog(shader);
      gl.attachShader(made, shader);
    });
    gl.linkProgram(made);
    return made;
  };
  const isFlat = film.kind === "points";
  const liquid = program(vertex[film.kind], isFlat ? round : fragment);
  const edges = program(vertex.mesh, fragment);
  const place = (of) => (name) => gl.getUniformLocation(of, name);
  const SECTORS = 96;

  // The box, as twelve edges; of a flat one, four.
  const box = [];
  for (let a = 0; a < 3; a++) {
    for (let k = 0; k < 4; k++) {
      const [b, c] = [(a + 1) % 3, (a + 2) % 3];
      const corner = [0, 0, 0];
      corner[b] = k & 1;
      corner[c] = k >> 1;
      const other = [...corner];
      other[a] = 1;
      box.push(...corner, ...other);
    }
  }
  const buffer = (target, content) => {
    const made = gl.createBuffer();
    gl.bindBuffer(target, made);
    gl.bufferData(target, content, gl.STATIC_DRAW);
    return made;
  };
  const attribute = (of, name, width, type, stride, offset, each) => {
    const at = gl.getAttribLocation(of, name);
    if (at < 0) return;
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, width, type, type !== gl.FLOAT, stride, offset);
    gl.vertexAttribDivisor(at, each);
  };
  const frame = gl.createVertexArray();
  gl.bindVertexArray(frame);
  buffer(gl.ARRAY_BUFFER, new Float32Array(box));
  attribute(edges, "place", 3, gl.FLOAT, 0, 0, 0);

  // What is shown: of an outline each line is an instance, turned about the axis.
  const load = async (shot) => {
    const { place, normal, tone, face } = await unpack(shot);
    const array = gl.createVertexArray();
    const parts = [];
    gl.bindVertexArray(array);
    if (film.kind === "outline") {
      const both = (values, Type) => {
        const out = new Type(2 * face.length);
        face.forEach((point, n) => {
          out[2 * n] = values[2 * point];
          out[2 * n + 1] = values[2 * point + 1];
        });
        return out;
      };
      parts.push(buffer(gl.ARRAY_BUFFER, both(place, Uint16Array)));
      attribute(liquid, "place", 4, gl.UNSIGNED_SHORT, 0, 0, 1);
      parts.push(buffer(gl.ARRAY_BUFFER, both(normal, Uint8Array)));
      attribute(liquid, "side", 4, gl.UNSIGNED_BYTE, 0, 0, 1);
    } else {
      const width = isFlat ? 2 : 3;
      parts.push(buffer(gl.ARRAY_BUFFER, place));
      attribute(liquid, "place", width, gl.UNSIGNED_SHORT, 0, 0, 0);
      if (isFlat) {
        parts.push(buffer(gl.ARRAY_BUFFER, tone));
        attribute(liquid, "tone", 3, gl.UNSIGNED_BYTE, 0, 0, 0);
      } else {
        parts.push(buffer(gl.ARRAY_BUFFER, normal));
        attribute(liquid, "side", width, gl.UNSIGNED_BYTE, 0, 0, 0);
        parts.push(buffer(gl.ELEMENT_ARRAY_BUFFER, face));
      }
    }
    gl.bindVertexArray(null);
    return { ...shot, data: null, array, parts };
  };

  const [width, depth, height] = film.size;
  const tops = film.shots.map(({ low, size }) => low[low.length - 1] + size[size.length - 1]);
  // Particles have a radius; what is far above an open box has left it.
  const top = isFlat
    ? Math.min(Math.max(...tops), 2 * height) + 0.55 * film.spacing
    : Math.min(Math.max(...tops), height);
  const target = [0.5 * width, 0.5 * depth, (isFlat ? 0.5 : 0.45) * top];
  let [azimuth, elevation, zoom] = isFlat ? [0, 0, 1] : [0.5, 0.42, 1];
  const radius = 0.5 * Math.hypot(width, depth, top);

  const product = (a, b) => {
    const out = new Array(16).fill(0);
    for (let i = 0; i < 4; i++) for (let j = 0; j < 4; j++) for (let k = 0; k < 4; k++) {
      out[4 * j + i] += a[4 * k + i] * b[4 * j + k];
    }
    return out;
  };
  let now = null;
  let wanted = 0;
  const draw = () => {
    const scale = window.devicePixelRatio || 1;
    const [w, h] = [canvas.clientWidth * scale, canvas.clientHeight * scale].map(Math.round);
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    gl.viewport(0, 0, w, h);
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const behind = dark ? [0.1, 0.115, 0.13] : [0.93, 0.94, 0.955];
    gl.clearColor(...behind, 1);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!now) return;
    const [sa, ca] = [Math.sin(azimuth), Math.cos(azimuth)];
    const [se, ce] = [Math.sin(elevation), Math.cos(elevation)];
    const away = [ce * sa, -ce * ca, se];
    const right = [ca, sa, 0];
    const up = [-se * sa, se * ca, ce];
    const angle = 0.45;
    const aspect = w / h;
    const fit = isFlat ? Math.max(0.5 * width / aspect, 0.5 * top) * 1.1 : radius;
    const distance = (fit / Math.tan(angle / 2) / Math.min(1, aspect) / zoom) * (isFlat ? 1 : 0.95);
    const eye = target.map((c, a) => c + distance * away[a]);
    const inner = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const look = [right[0], up[0], away[0], 0, right[1], up[1], away[1], 0,
      right[2], up[2], away[2], 0, -inner(right, eye), -inner(up, eye), -inner(away, eye), 1];
    const f = 1 / Math.tan(angle / 2);
    const [near, far] = [0.02 * distance, distance + 4 * radius];
    const lens = [f / aspect, 0, 0, 0, 0, f, 0, 0,
      0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0];
    const view = product(lens, look);

    gl.useProgram(edges);
    gl.bindVertexArray(frame);
    gl.uniformMatrix4fv(place(edges)("view"), false, view);
    gl.uniform3f(place(edges)("low"), 0, 0, 0);
    gl.uniform3f(place(edges)("size"), width, depth, height);
    gl.uniform3fv(place(edges)("tint"), dark ? [0.35, 0.38, 0.42] : [0.72, 0.75, 0.78]);
    gl.uniform1f(place(edges)("flat_"), 1);
    gl.drawArrays(gl.LINES, 0, 24);

    const at = place(liquid);
    gl.useProgram(liquid);
    gl.bindVertexArray(now.array);
    gl.uniformMatrix4fv(at("view"), false, view);
    const wide = (v) => (v.length === 3 ? v : [v[0], 0, v[1]]);
    gl.uniform3fv(at("low"), wide(now.low));
    gl.uniform3fv(at("size"), wide(now.size));
    gl.uniform3fv(at("eye"), eye);
    gl.uniform3f(at("tint"), 0.16, 0.44, 0.66);
    gl.uniform1f(at("flat_"), isFlat ? 1 : 0);
    if (film.kind === "outline") {
      gl.uniform2f(at("axis"), 0.5 * width, 0.5 * depth);
      gl.uniform1f(at("sectors"), SECTORS);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 2 * (SECTORS + 1), now.faces);
    } else if (isFlat) {
      gl.uniform1f(at("dot_"), Math.max(1.5, (1.1 * film.spacing * h * f) / (2 * distance)));
      gl.drawArrays(gl.POINTS, 0, now.points);
    } else {
      gl.drawElements(gl.TRIANGLES, 3 * now.faces, gl.UNSIGNED_INT, 0);
    }
  };

  const [slider, clock, play] = [element("time"), element("clock"), element("play")];
  slider.max = film.shots.length - 1;
  slider.value = 0;
  const { ms: last } = film.shots[film.shots.length - 1];
  const apart = (last - film.shots[0].ms) / Math.max(1, film.shots.length - 1);
  const places = Math.min(6, Math.max(2, 1 - Math.floor(Math.log10(apart || 1))));
  const show = async (index) => {
    wanted = index;
    slider.value = index;
    const { ms } = film.shots[index];
    clock.textContent = `${ms.toFixed(places)} ms`.replace("-", "\u2212");
    times.forEach((show) => show(ms));
    const loaded = await load(film.shots[index]);
    const drop = ({ array, parts }) => {
      gl.deleteVertexArray(array);
      parts.forEach((part) => gl.deleteBuffer(part));
    };
    // Another one may have been asked for meanwhile.
    if (wanted !== index) return drop(loaded);
    if (now) drop(now);
    now = loaded;
    canvas.dataset.shown = index;
    draw();
  };
  jump = (ms) => {
    const far = film.shots.map((shot) => Math.abs(shot.ms - ms));
    const index = far.indexOf(Math.min(...far));
    if (index !== wanted) show(index);
  };
  slider.addEventListener("input", () => show(Number(slider.value)));
  let playing = false;
  play.addEventListener("click", async () => {
    playing = !playing;
    play.textContent = playing ? "Pause" : "Play";
    while (playing) {
      const wait = new Promise((done) => setTimeout(done, 120));
      await show((wanted + 1) % film.shots.length);
      await wait;
    }
  });

  const fingers = new Map();
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  const closer = (factor) => {
    zoom = Math.min(12, Math.max(0.4, zoom * factor));
    draw();
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const old = fingers.size === 2 ? spread() : 0;
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (old > 0) return closer(spread() / old);
    if (isFlat) return;
    azimuth -= 0.008 * (event.clientX - before.x);
    elevation = Math.min(1.5, Math.max(-1.2, elevation + 0.008 * (event.clientY - before.y)));
    draw();
  });
  ["pointerup", "pointercancel"].forEach((name) =>
    canvas.addEventListener(name, (event) => fingers.delete(event.pointerId)));
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    closer(Math.exp(-0.0015 * event.deltaY));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const step = steps[event.key];
    if (!step || isFlat) return;
    event.preventDefault();
    azimuth += 0.08 * step[0];
    elevation = Math.min(1.5, Math.max(-1.2, elevation + 0.08 * step[1]));
    draw();
  });
  element("player").hidden = false;
  new ResizeObserver(draw).observe(canvas);
  show(Math.min(film.shots.length - 1, Math.round(0.3 * film.shots.length)));
})();
