(function(){"use strict";const $t="html,body{margin:0;height:100%;overflow:hidden;background:#fff;font:13px DejaVu Sans,Verdana,Arial,sans-serif;color:#17171c}#poster{position:absolute;inset:0;margin:auto;max-width:100%;max-height:100%;width:100%;height:100%;object-fit:contain}.sentence{position:absolute;left:0;right:0;bottom:0;margin:0;padding:.6em 1em;background:#fffbe6;text-align:center}.stage{position:absolute;inset:0;touch-action:none;outline:none}.stage>canvas{position:absolute;inset:0;width:100%;height:100%;display:block}.stage>canvas+canvas{pointer-events:none}.bar{position:absolute;left:6px;top:6px;display:flex;flex-wrap:wrap;gap:2px;opacity:.35;transition:opacity .2s;max-width:calc(100% - 12px);align-items:flex-start}.bar:hover,.bar:focus-within,.bar:has([open]),.times,.editor{opacity:1}.timed .stage{bottom:36px}.times{inset:auto 0 0;height:36px;max-width:none;justify-content:center;align-items:center;gap:8px;background:#f4f4f6}.times input{width:240px;max-width:40vw}button,select,summary{font:inherit;font-size:12px;color:inherit;background:#ffffffd8;border:1px solid #0003;border-radius:4px;padding:2px 7px;cursor:pointer}button:hover,summary:hover{background:#e8f0ff}.editor{position:absolute;left:8px;bottom:8px;padding:8px;background:#fffffff0;border:1px solid #0003;border-radius:6px;width:360px}.editor[hidden]{display:none}.editor canvas{display:block;cursor:crosshair;touch-action:none;background:#fafafa}.editor .row{display:flex;gap:6px;margin-top:6px;align-items:center}.editor .words{flex:1;min-width:0;font:11px monospace}.about{position:relative}.about[open]{background:#fffffff0;border:1px solid #0003;border-radius:6px;padding:0 10px 8px 0;max-width:440px;max-height:70vh;overflow:auto}.about summary{list-style:none;display:inline-block}.about p,.about ul,.about pre{margin:6px 0 0 10px}.about pre{font-size:11px;white-space:pre-wrap}@media(prefers-reduced-motion:reduce){.bar{transition:none}}";function Ht(a,t,e){const o=new Map,i=()=>a.layout.area.height;t.addEventListener("contextmenu",s=>s.preventDefault()),t.addEventListener("pointerdown",s=>{t.setPointerCapture(s.pointerId),t.focus(),o.set(s.pointerId,{x:s.clientX,y:s.clientY})});const r=s=>o.delete(s.pointerId);t.addEventListener("pointerup",r),t.addEventListener("pointercancel",r),t.addEventListener("pointermove",s=>{const n=o.get(s.pointerId);if(!n)return;const l=s.clientX-n.x,c=s.clientY-n.y;if(o.size===1)s.buttons&6||s.shiftKey?a.camera.pan(l/i(),c/i()):s.ctrlKey||s.metaKey?a.camera.roll(l/i()*Math.PI):a.camera.turn(l/i()*Math.PI,c/i()*Math.PI);else if(o.size===2){const u=[...o].find(([d])=>d!==s.pointerId)[1],h=Math.hypot(n.x-u.x,n.y-u.y),f=Math.hypot(s.clientX-u.x,s.clientY-u.y);h>0&&f>0&&a.camera.zoom(f/h),a.camera.pan(.5*l/i(),.5*c/i())}o.set(s.pointerId,{x:s.clientX,y:s.clientY}),a.draw(!0)}),t.addEventListener("wheel",s=>{s.preventDefault(),a.camera.zoom(Math.exp(-s.deltaY*(s.deltaMode===1?.05:.0015))),a.draw(!0)},{passive:!1}),t.addEventListener("keydown",s=>{const l={ArrowLeft:[-1,0],ArrowRight:[1,0],ArrowUp:[0,-1],ArrowDown:[0,1]}[s.key];if(l&&s.shiftKey)a.camera.pan(.05*l[0],.05*l[1]);else if(l)a.camera.turn(.1*l[0],.1*l[1]);else if(s.key==="+"||s.key==="=")a.camera.zoom(1.1);else if(s.key==="-")a.camera.zoom(1/1.1);else if(e[s.key]&&!s.ctrlKey&&!s.metaKey&&!s.altKey)e[s.key]();else return;s.preventDefault(),a.draw(!0)})}function T(a,t={},...e){const o=Object.assign(document.createElement(a),t);return o.append(...e),o}const N=(a,t,e)=>T("button",{type:"button",textContent:a,title:t,onclick:e,ariaLabel:t}),jt=a=>a<=.04045?a/12.92:((a+.055)/1.055)**2.4,St=a=>a<=.0031308?12.92*a:1.055*a**(1/2.4)-.055,X=a=>`rgb(${a[0]} ${a[1]} ${a[2]})`,Ft=a=>X([0,1,2].map(t=>Math.round(255*a[t]))),R=360,D=150,Gt=9;function Xt(a){const t=e=>String(Number(e.toPrecision(5)));return`volume opacity=${a.map(([e,o])=>`@${t(e)}:${t(o)}`).join(",")}`}class qt{constructor(t){this.v=t,this.canvas=T("canvas",{tabIndex:0,ariaLabel:"Opacity over values"}),this.words=T("input",{readOnly:!0,className:"words",ariaLabel:"The same on the command line"}),this.logarithmic=!0,this.held=-1;const e=t.step.volumes[0].info;this.points=e.opacity.map(([l,c])=>[l,c]),this.most=Math.max(.02,...this.points.map(([,l])=>l));const o=Math.min(2,window.devicePixelRatio||1);this.canvas.width=R*o,this.canvas.height=D*o,this.canvas.style.width=`${R}px`,this.canvas.style.height=`${D}px`,this.canvas.getContext("2d").scale(o,o);const i=T("input",{type:"checkbox",checked:!0});i.onchange=()=>{this.logarithmic=i.checked,this.paint()};const r=T("select",{ariaLabel:"Largest opacity shown",title:"Largest opacity shown"},...["0.02","0.05","0.1","0.2","0.5","1"].map(l=>T("option",{value:l,textContent:`to ${l}`})));this.most=[.02,.05,.1,.2,.5,1].find(l=>l>=this.most*.999)??1,r.value=String(this.most),r.onchange=()=>{this.most=Number(r.value),this.paint()};const s=N("reset","The opacity of the picture",()=>{this.points=e.opacity.map(([l,c])=>[l,c]),this.changed()}),n=N("copy","Copy the words for the command line",()=>{this.words.select(),document.execCommand("copy")});this.panel=T("div",{className:"editor",hidden:!0},this.canvas,T("div",{className:"row"},T("label",{},i," log counts"),r,s),T("div",{className:"row"},this.words,n)),this.canvas.onpointerdown=l=>this.press(l),this.canvas.onpointermove=l=>this.drag(l),this.canvas.onpointerup=this.canvas.onpointercancel=()=>{this.held=-1},this.canvas.ondblclick=l=>{const c=this.nearest(l);c>=0&&this.points.length>1&&(this.points.splice(c,1),this.changed())},this.paint()}x(t){const[e,o]=this.v.step.volumes[0].info.told;return(t-e)/(o-e||1)*(R-1)}value(t){const[e,o]=this.v.step.volumes[0].info.told;return e+Math.min(R-1,Math.max(0,t))/(R-1)*(o-e)}y(t){return(D-1)*(1-t/this.most)}at(t){const e=this.canvas.getBoundingClientRect();return[t.clientX-e.left,t.clientY-e.top]}nearest(t){const[e,o]=this.at(t);let i=-1,r=Gt;return this.points.forEach(([s,n],l)=>{const c=Math.hypot(this.x(s)-e,Math.min(D-1,Math.max(0,this.y(n)))-o);c<r&&(r=c,i=l)}),i}press(t){if(this.canvas.setPointerCapture(t.pointerId),this.held=this.nearest(t),this.held>=0)return;const[e,o]=this.at(t),i=[this.value(e),this.opacity(o)];this.held=this.points.findIndex(([r])=>r>i[0]),this.held<0&&(this.held=this.points.length),this.points.splice(this.held,0,i),this.changed()}opacity(t){return Math.min(1,Math.max(0,(1-t/(D-1))*this.most))}drag(t){if(this.held<0||!t.buttons)return;const[e,o]=this.at(t),i=this.points[this.held-1]?.[0]??-1/0,r=this.points[this.held+1]?.[0]??1/0;this.points[this.held]=[Math.min(r,Math.max(i,this.value(e))),this.opacity(o)],this.changed()}changed(){this.v.setOpacity(this.points.map(([t,e])=>[t,e])),this.paint()}paint(){const t=this.canvas.getContext("2d"),e=this.v.step.volumes[0],{histogram:o,told:i}=e.info,r=o.length;t.clearRect(0,0,R,D);const s=l=>this.logarithmic?Math.log1p(l):l,n=Math.max(1e-9,...o.map(s));for(let l=0;l<r;++l){const c=Array.from(e.scale.color(i[0]+(l+.5)/r*(i[1]-i[0]))).slice(0,3).map(h=>Math.round(255*St(h))),u=s(o[l])/n*(D-4);t.fillStyle=X(c),t.fillRect(l*R/r,D-u,R/r+.5,u)}t.strokeStyle="#111",t.lineWidth=1.5,t.beginPath(),t.moveTo(0,this.y(this.points[0]?.[1]??0));for(const[l,c]of this.points)t.lineTo(this.x(l),this.y(c));t.lineTo(R,this.y(this.points.at(-1)?.[1]??0)),t.stroke();for(const[l,c]of this.points)t.beginPath(),t.arc(this.x(l),Math.min(D-1,Math.max(0,this.y(c))),4.5,0,2*Math.PI),t.fillStyle="#fff",t.fill(),t.stroke();this.words.value=`--show '${Xt(this.points)}'`}}const Wt=8;function Yt(a){const t=a.scene.steps.length,e=T("input",{type:"range",min:"0",max:String(t-1),step:"1",value:"0",ariaLabel:"Time step"}),o=T("span",{className:"time"});let i=0;const r=()=>{const c=a.scene.steps[a.number].time;o.textContent=`${a.number+1} of ${t}${c===void 0?"":`, t = ${Number(c.toPrecision(6))}`}`,e.value=String(a.number)},s=async()=>{const c=performance.now();await a.show((a.number+1)%t),i&&(i=window.setTimeout(s,Math.max(0,1e3/Wt-(performance.now()-c))))},n=()=>{i?(clearTimeout(i),i=0):i=window.setTimeout(s,0),l.textContent=i?"❚❚":"►"},l=N("►","Play (space)",n);return e.oninput=()=>void a.show(Number(e.value)),r(),{bar:T("div",{className:"bar times"},l,e,o),play:n,tell:r}}function Kt(a,t,e){const o=T("div",{className:"bar",role:"toolbar",ariaLabel:"Camera"}),i={},r=u=>()=>{const h=a.scene.views[u];a.camera.fit(a.step.box??a.step.bounds,h.direction,h.up,a.aspect(),a.scene.margin),a.draw(!1)};Object.keys(a.scene.views).forEach((u,h)=>{o.append(N(u,`View: ${u} (${h+1})`,r(u))),i[String(h+1)]=r(u)});const s=()=>{a.camera.set(a.first.copy()),a.draw(!1)},n=()=>{a.camera.setParallel(!a.camera.parallel),c.textContent=a.camera.parallel?"parallel":"perspective",a.draw(!1)},l=()=>{a.axes=!a.axes,a.draw(!1)},c=N(a.camera.parallel?"parallel":"perspective","Perspective or parallel projection (p)",n);return i.r=s,i.p=n,i.a=l,o.append(N("reset","The view of the picture (r)",s),c),a.step.annotation.axes&&o.append(N("axes","Box, numbers and orientation (a)",l)),o.append(N("save","Save what is seen as PNG",()=>{a.snapshot().toBlob(u=>{if(!u)return;const h=T("a",{href:URL.createObjectURL(u),download:`${t||"picture"}.png`});h.click(),setTimeout(()=>URL.revokeObjectURL(h.href),1e4)})})),o.append(...e),{bar:o,keys:i}}function Jt(a,t){const e=T("ul",{},...a.map(r=>T("li",{textContent:r}))),i=T("details",{className:"about"},T("summary",{textContent:"about",title:"What is in this page"}),T("p",{textContent:"Drag turns, with shift or the right button it shifts, with ctrl it rolls; the wheel zooms; arrows, + and − too."}));return a.length&&i.append(T("p",{textContent:"To keep within its size, or for speed:"}),e),t&&i.append(T("p",{textContent:"The picture's pipeline:"}),T("pre",{textContent:t})),i}function Qt(a){const t=Uint8Array;if(t.fromBase64)return t.fromBase64(a);const e=atob(a),o=new Uint8Array(e.length);for(let i=0;i<e.length;++i)o[i]=e.charCodeAt(i);return o}async function Zt(a){const t=new Blob([a]).stream().pipeThrough(new DecompressionStream("deflate-raw"));return new Uint8Array(await new Response(t).arrayBuffer())}function te(a){switch(a.type){case"u8":return new Uint8Array(a.count);case"u16":return new Uint16Array(a.count);case"u32":return new Uint32Array(a.count);default:return new Float32Array(a.count)}}function ee(a,t){const e=te(a),o=e.BYTES_PER_ELEMENT,i=a.count,r=a.stride;if(t.length!==i*o)throw new Error(`an array has ${t.length} bytes, not ${i*o}: the file is damaged`);if(a.coding==="plain")new Uint8Array(e.buffer).set(t);else if(a.coding==="planes"){const s=new Uint8Array(e.buffer);for(let n=0;n<o;++n)for(let l=0,c=n*i;l<i;++l)s[l*o+n]=t[c+l]}else for(let s=0;s<i;++s){let n=t[s];o>1&&(n|=t[i+s]<<8),o>2&&(n|=t[2*i+s]<<16|t[3*i+s]<<24);const l=n>>>1^-(n&1);e[s]=s>=r?l+e[s-r]:l}return e}class oe{constructor(t,e){this.infos=t,this.text=e,this.kept=new Map}get(t){let e=this.kept.get(t);return e||(e=Zt(Qt(this.text(t))).then(o=>ee(this.infos[t],o)),this.kept.set(t,e)),e}}class O{constructor(t,e,o){this.gl=t,this.places=new Map;const i=t.createProgram();for(const[r,s]of[[t.VERTEX_SHADER,e],[t.FRAGMENT_SHADER,o]]){const n=t.createShader(r);if(t.shaderSource(n,`#version 300 es
precision highp float;
precision highp int;
precision highp sampler3D;
`+s),t.compileShader(n),!t.getShaderParameter(n,t.COMPILE_STATUS))throw new Error(t.getShaderInfoLog(n)??"a shader cannot be compiled");t.attachShader(i,n)}if(t.linkProgram(i),!t.getProgramParameter(i,t.LINK_STATUS))throw new Error(t.getProgramInfoLog(i)??"a program cannot be linked");this.handle=i}use(){this.gl.useProgram(this.handle)}place(t){return this.places.has(t)||this.places.set(t,this.gl.getUniformLocation(this.handle,t)),this.places.get(t)}f(t,...e){const o=this.gl,i=this.place(t);e.length===1?o.uniform1f(i,e[0]):e.length===2?o.uniform2f(i,e[0],e[1]):e.length===3?o.uniform3f(i,e[0],e[1],e[2]):o.uniform4f(i,e[0],e[1],e[2],e[3])}i(t,e){this.gl.uniform1i(this.place(t),e)}texture(t,e,o,i=this.gl.TEXTURE_2D){this.gl.activeTexture(this.gl.TEXTURE0+e),this.gl.bindTexture(i,o),this.i(t,e)}}function F(a,t,e,o,i=0,r=a.FLOAT,s=!1,n=0,l=0){const c=a.createBuffer();return a.bindBuffer(a.ARRAY_BUFFER,c),a.bufferData(a.ARRAY_BUFFER,e,a.STATIC_DRAW),ae(a,t,c,o,i,r,s,n,l),c}function ae(a,t,e,o,i,r,s,n,l){a.bindBuffer(a.ARRAY_BUFFER,e),a.enableVertexAttribArray(t),a.vertexAttribPointer(t,o,r,s,n,l),a.vertexAttribDivisor(t,i)}class q{constructor(t,e,o){this.gl=t,this.format=e,this.withDepth=o,this.width=0,this.height=0,this.color=null,this.depth=null,this.frame=t.createFramebuffer()}resize(t,e){if(t===this.width&&e===this.height)return;const o=this.gl;this.width=t,this.height=e,o.deleteTexture(this.color),o.deleteTexture(this.depth),o.bindFramebuffer(o.FRAMEBUFFER,this.frame),this.color=dt(o,this.format,t,e,o.LINEAR),o.framebufferTexture2D(o.FRAMEBUFFER,o.COLOR_ATTACHMENT0,o.TEXTURE_2D,this.color,0),this.withDepth&&(this.depth=dt(o,o.DEPTH24_STENCIL8,t,e,o.NEAREST),o.framebufferTexture2D(o.FRAMEBUFFER,o.DEPTH_STENCIL_ATTACHMENT,o.TEXTURE_2D,this.depth,0))}bind(){this.gl.bindFramebuffer(this.gl.FRAMEBUFFER,this.frame),this.gl.viewport(0,0,this.width,this.height)}}function dt(a,t,e,o,i){const r=a.createTexture();a.activeTexture(a.TEXTURE0),a.bindTexture(a.TEXTURE_2D,r),a.texStorage2D(a.TEXTURE_2D,1,t,e,o);for(const[s,n]of[[a.TEXTURE_MIN_FILTER,i],[a.TEXTURE_MAG_FILTER,i],[a.TEXTURE_WRAP_S,a.CLAMP_TO_EDGE],[a.TEXTURE_WRAP_T,a.CLAMP_TO_EDGE]])a.texParameteri(a.TEXTURE_2D,s,n);return r}function mt(a,t){const e=t.length/4,o=Math.max(1,Math.ceil(e/1024)),i=new Float32Array(o*4096);i.set(t);const r=dt(a,a.RGBA32F,1024,o,a.NEAREST);return a.texSubImage2D(a.TEXTURE_2D,0,0,0,1024,o,a.RGBA,a.FLOAT,i),r}const pt=`
void main() {
  gl_Position = vec4((gl_VertexID & 1) == 1 ? 3.0 : -1.0, (gl_VertexID & 2) == 2 ? 3.0 : -1.0, 0.0, 1.0);
}`,ie=`
uniform sampler2D uFrom;
out vec4 oColor;
void main() { oColor = texelFetch(uFrom, ivec2(gl_FragCoord.xy), 0); }`,se=`
uniform sampler2D uFrom;
uniform vec4 uArea;       /* of the picture in the window, lower left corner and size */
uniform vec2 uWindow;
uniform float uSamples;   /* along an axis per pixel, a whole number */
uniform vec3 uBottom, uTop;
out vec4 oColor;
vec3 fromSrgb(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(vec3(0.04045), c)); }
vec3 toSrgb(vec3 c) { return mix(12.92 * c, 1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), c)); }
void main() {
  float row = uWindow.y > 1.5 ? (gl_FragCoord.y - 0.5) / (uWindow.y - 1.0) : 0.0;
  vec3 background = fromSrgb(mix(uBottom, uTop, clamp(row, 0.0, 1.0)));
  vec4 c = vec4(0.0);
  vec2 at = gl_FragCoord.xy - uArea.xy;
  if (all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, uArea.zw))) {
    int n = int(uSamples + 0.5);
    ivec2 first = ivec2(floor(at)) * n;
    for (int j = 0; j < n; ++j) for (int i = 0; i < n; ++i) c += min(texelFetch(uFrom, first + ivec2(i, j), 0), vec4(65000.0));
    c /= float(n * n);
  }
  oColor = vec4(toSrgb(min(c.rgb + (1.0 - c.a) * background, vec3(1.0))), 1.0);
}`;class re{constructor(t,e){this.gl=t,this.scene=e,this.limit=null,this.limiter=null,this.zero=null;const i=t.getExtension("EXT_color_buffer_float")||t.getExtension("EXT_color_buffer_half_float")?t.RGBA16F:t.SRGB8_ALPHA8;this.copy=new O(t,pt,ie),this.resolve=new O(t,pt,se),this.opaque=new q(t,i,!0),this.sum=new q(t,i,!1),this.layers=[new q(t,i,!0),new q(t,i,!0)]}draw(t,e,o,i,r){const s=this.gl,n=t.projection.width,l=t.projection.height,c=e.filter(d=>d.translucent);for(const d of[this.opaque,this.sum])d.resize(n,l);if(c.length)for(const d of this.layers)d.resize(n,l);s.enable(s.SCISSOR_TEST);const[u,h]=r??[0,l];s.scissor(0,u,n,h-u),this.drawOpaque(t,e),this.sum.bind(),s.clearColor(0,0,0,0),s.clear(s.COLOR_BUFFER_BIT);let f=null;for(let d=0;d<(c.length?i.layers:0);++d){const m=this.layers[d%2],v=d>0?this.layers[(d+1)%2].depth:null;m.bind(),s.enable(s.DEPTH_TEST),s.depthFunc(s.LESS),s.depthMask(!0),s.disable(s.BLEND),s.clearColor(0,0,0,0),s.clearDepth(1),s.clear(s.COLOR_BUFFER_BIT|s.DEPTH_BUFFER_BIT);const g={before:v??this.nothing(),hiding:this.opaque.depth};for(const p of c)p.draw({...t,peel:g});for(const p of o)this.drawVolume(p,t,f,this.nearer(m,n,l),i.coarse);this.under(m.color),f=m.depth}for(const d of o)this.drawVolume(d,t,f,this.opaque.depth,i.coarse);this.under(this.opaque.color),s.disable(s.SCISSOR_TEST)}drawOpaque(t,e){const o=this.gl;this.opaque.bind(),o.enable(o.DEPTH_TEST),o.depthFunc(o.LESS),o.depthMask(!0),o.disable(o.BLEND),o.disable(o.CULL_FACE),o.disable(o.STENCIL_TEST),o.clearColor(0,0,0,0),o.clearDepth(1),o.clearStencil(0),o.clear(o.COLOR_BUFFER_BIT|o.DEPTH_BUFFER_BIT|o.STENCIL_BUFFER_BIT);for(const i of["surface","edges","marks"])for(const r of e)!r.translucent&&r.stage===i&&r.draw({...t,peel:null})}drawVolume(t,e,o,i,r){const s=this.gl;this.sum.bind(),s.disable(s.DEPTH_TEST),s.enable(s.BLEND),s.blendFunc(s.ONE_MINUS_DST_ALPHA,s.ONE),t.draw({...e,peel:null},o,i,r),s.disable(s.BLEND)}nearer(t,e,o){const i=this.gl;return this.limit??=new q(i,i.R32F,!1),this.limit.resize(e,o),this.limit.bind(),this.limiter??=new O(i,pt,`
uniform sampler2D uOne, uOther;
out vec4 oColor;
void main() { ivec2 at = ivec2(gl_FragCoord.xy); oColor = vec4(min(texelFetch(uOne, at, 0).r, texelFetch(uOther, at, 0).r)); }`),this.limiter.use(),this.limiter.texture("uOne",0,t.depth),this.limiter.texture("uOther",1,this.opaque.depth),i.disable(i.DEPTH_TEST),i.drawArrays(i.TRIANGLES,0,3),this.limit.color}under(t){const e=this.gl;this.sum.bind(),e.disable(e.DEPTH_TEST),e.enable(e.BLEND),e.blendFunc(e.ONE_MINUS_DST_ALPHA,e.ONE),this.copy.use(),this.copy.texture("uFrom",0,t),e.drawArrays(e.TRIANGLES,0,3),e.disable(e.BLEND)}nothing(){const t=this.gl,e=t.getParameter(t.FRAMEBUFFER_BINDING),o=this.zero??=new q(t,t.R8,!1);return o.resize(this.opaque.width,this.opaque.height),t.bindFramebuffer(t.FRAMEBUFFER,o.frame),t.clear(t.COLOR_BUFFER_BIT),t.bindFramebuffer(t.FRAMEBUFFER,e),o.color}finish(){const t=this.gl;this.sum.color&&(t.bindFramebuffer(t.FRAMEBUFFER,this.sum.frame),t.readPixels(0,0,1,1,t.RGBA,t.FLOAT,new Float32Array(4)))}present(t,e,o,i){const r=this.gl,s=this.resolve,n=this.scene;r.bindFramebuffer(r.FRAMEBUFFER,null),r.viewport(0,0,t,e),r.disable(r.DEPTH_TEST),r.disable(r.BLEND),r.disable(r.SCISSOR_TEST),s.use(),s.texture("uFrom",0,this.sum.color),s.f("uArea",o.x,o.y,o.width,o.height),s.f("uWindow",t,e),s.f("uSamples",i),s.f("uBottom",...n.background),s.f("uTop",...n.background_top),r.drawArrays(r.TRIANGLES,0,3)}}const L=(a,t)=>[a[0]+t[0],a[1]+t[1],a[2]+t[2]],C=(a,t)=>[a[0]-t[0],a[1]-t[1],a[2]-t[2]],P=(a,t)=>[a[0]*t,a[1]*t,a[2]*t],_=(a,t)=>a[0]*t[0]+a[1]*t[1]+a[2]*t[2],it=(a,t)=>[a[1]*t[2]-a[2]*t[1],a[2]*t[0]-a[0]*t[2],a[0]*t[1]-a[1]*t[0]],W=a=>Math.hypot(a[0],a[1],a[2]),U=a=>P(a,1/(W(a)||1));function gt(a,t,e){const o=Math.cos(e),i=Math.sin(e);return L(L(P(a,o),P(it(t,a),i)),P(t,_(t,a)*(1-o)))}const ne=(a,t)=>[a[0]*t[0]+a[1]*t[1]+a[2]*t[2],a[3]*t[0]+a[4]*t[1]+a[5]*t[2],a[6]*t[0]+a[7]*t[1]+a[8]*t[2]];function le(a,t){const e=new Float32Array(4*a.lights.length);return a.lights.forEach((o,i)=>{const r=o.direction,s=o.follows?C(L(P(t.right,r[0]),P(t.up,r[1])),P(t.forward,r[2])):r;e.set([...U(s),o.intensity],4*i)}),e}function J(a,t){const e=t.projection;a.f("uEye",...C(e.eye,t.center)),a.f("uRight",...e.right),a.f("uUp",...e.up),a.f("uForward",...e.forward),a.f("uSize",e.width,e.height),a.f("uScale",e.scale),a.f("uNear",e.near),a.f("uFar",e.far),a.f("uSamples",t.samples),a.i("uParallel",e.parallel?1:0),a.i("uLampCount",Math.min(8,t.lamps.length/4)),a.gl.uniform4fv(a.place("uLamps"),t.lamps.subarray(0,32)),a.i("uPeeling",t.peel?1:0),a.texture("uBefore",6,t.peel?.before??null),a.texture("uHiding",7,t.peel?.hiding??null)}function Ct(a,t,e,o){const i=a.gl;if(e||!t.soft){a.i("uSoft",0),o();return}a.i("uSoft",1),o(),i.enable(i.BLEND),i.blendEquation(i.MAX),i.depthMask(!1),a.i("uSoft",2),o(),i.disable(i.BLEND),i.blendEquation(i.FUNC_ADD),i.depthMask(!0)}const ce=3e38;class he{constructor(t,e,o){this.info=e,this.linear=new Float32Array(o.length);for(let r=0;r<o.length;++r)this.linear[r]=jt(o[r]/65535);const i=new Float32Array(o.length/3*4);for(let r=0;r<o.length/3;++r){for(let s=0;s<3;++s)i[4*r+s]=this.linear[3*r+s];i[4*r+3]=1}this.texture=mt(t,i),this.ends=e.kind==="log"?[0,Math.log(e.hi/e.lo)]:e.kind==="symlog"?[xt(e.lo/e.threshold),xt(e.hi/e.threshold)]:[0,1]}stored(t){if(t!==t)return ce;if(this.info.labels.length||this.info.kind==="linear")return t;const e=this.ends[0]+t*(this.ends[1]-this.ends[0]);return this.info.kind==="log"?Math.exp(Math.min(e,85)):Pt(e)}position(t){const e=this.info;if(e.labels.length){const o=e.labels.findIndex(i=>Math.fround(i)===Math.fround(t));return o<0?NaN:(o+.5)/e.labels.length}return e.lo===e.hi?t===e.lo?.5:t<e.lo?-1:2:e.kind==="log"?t>0?Math.log(t/e.lo)/Math.log(e.hi/e.lo):e.lo<=e.hi?-1:2:e.kind==="symlog"?(xt(t/e.threshold)-this.ends[0])/(this.ends[1]-this.ends[0]):(t-e.lo)/(e.hi-e.lo)}value(t){const e=this.info;return e.labels.length?e.labels[Math.min(e.labels.length-1,Math.max(0,Math.floor(t*e.labels.length)))]:e.kind==="log"?e.lo*(e.hi/e.lo)**t:e.kind==="symlog"?e.threshold*Pt(this.ends[0]+t*(this.ends[1]-this.ends[0])):e.lo*(1-t)+e.hi*t}color(t){const e=this.position(t),o=this.info.size;if(e!==e)return this.info.nan;if(e<0)return this.info.below;if(e>1)return this.info.above;const i=3*Math.floor(e*(o-1)+.5);return[this.linear[i],this.linear[i+1],this.linear[i+2],1]}bind(t,e){const o=this.info;t.texture("uTable",e,this.texture),t.i("uTableSize",o.size),t.i("uScaleKind",o.labels.length||o.kind==="linear"?0:o.kind==="log"?1:2),t.f("uScaleEnds",...this.ends),t.f("uBelow",...o.below),t.f("uAbove",...o.above),t.f("uNan",...o.nan)}}const xt=a=>Math.abs(a)<=1?a:Math.sign(a)*(1+Math.log10(Math.abs(a))),Pt=a=>Math.abs(a)<=1?a:Math.sign(a)*10**(Math.abs(a)-1);async function ue(a,t,e){return Promise.all(t.map(async o=>new he(a,o,await e.get(o.colors))))}const _t=a=>P(L(a.lo,a.hi),.5),Lt=a=>W(C(a.hi,a.lo)),B=(a,t)=>[t&1?a.hi[0]:a.lo[0],t&2?a.hi[1]:a.lo[1],t&4?a.hi[2]:a.lo[2]];function st(a,t){const e=U(a);let o=it(e,U(t));if(!(W(o)>1e-9)){const i=e.map(Math.abs);o=it(e,i[1]<=i[0]&&i[1]<=i[2]?[0,1,0]:i[2]<=i[0]?[0,0,1]:[1,0,0])}return o=U(o),{right:o,up:it(o,e),forward:e}}class rt{constructor(t){this.position=[...t.position],this.target=[...t.target],this.up=[...t.up],this.angle=t.angle,this.parallel=t.parallel,this.height=t.height}set(t){Object.assign(this,t)}copy(){return new rt(this)}projection(t,e,o,i){const r=st(C(this.target,this.position),this.up),s=Math.min(e,t/o),n=this.parallel?s/this.height:.5*s/Math.tan(this.angle*Math.PI/360);let l=1/0,c=-1/0;for(let d=0;d<8;++d){const m=_(C(B(i,d),this.position),r.forward);l=Math.min(l,m),c=Math.max(c,m)}const u=.02*Math.max(c-l,.001*Math.max(Math.abs(c),Math.abs(l))),h=c>0?c+u:Lt(i)||1,f=this.parallel?l-u:Math.max(l-u,.001*h);return{...r,width:t,height:e,parallel:this.parallel,eye:this.position,scale:n,near:f,far:h}}turn(t,e){const o=st(C(this.target,this.position),this.up),i=L(P(o.up,-t),P(o.right,-e)),r=W(i);if(!(r>0))return;const s=U(i);this.position=L(this.target,gt(C(this.position,this.target),s,r)),this.up=U(gt(o.up,s,r))}roll(t){this.up=gt(this.up,U(C(this.position,this.target)),t)}pan(t,e){const o=st(C(this.target,this.position),this.up),i=this.parallel?this.height:2*W(C(this.target,this.position))*Math.tan(this.angle*Math.PI/360),r=L(P(o.right,-t*i),P(o.up,e*i));this.position=L(this.position,r),this.target=L(this.target,r)}zoom(t){this.height/=t,this.position=L(this.target,P(C(this.position,this.target),1/t))}setParallel(t){if(t===this.parallel)return;const e=2*Math.tan(this.angle*Math.PI/360),o=C(this.position,this.target);t?this.height=W(o)*e:this.position=L(this.target,P(U(o),this.height/e)),this.parallel=t}fit(t,e,o,i,r){const s=_t(t),n=Lt(t)||1,l=st(P(e,-1),o),c=1-2*r,u=Array.from({length:8},(y,b)=>C(B(t,b),s)).map(y=>[_(y,l.right),_(y,l.up),_(y,l.forward)]);this.up=l.up;const h=Math.max(...u.map(y=>Math.abs(y[0]))),f=Math.max(...u.map(y=>Math.abs(y[1])));if(this.height=2*Math.max(f,h/i)/c||n,this.parallel){this.target=s,this.position=C(s,P(l.forward,2*n));return}const d=Math.tan(this.angle*Math.PI/360)*c,m=d*i,v=Math.max(...u.map(y=>y[0]-m*y[2])),g=Math.max(...u.map(y=>-y[0]-m*y[2])),p=Math.max(...u.map(y=>y[1]-d*y[2])),x=Math.max(...u.map(y=>-y[1]-d*y[2]));let w=Math.max((v+g)/(2*m),(p+x)/(2*d));w=Math.max(w,.05*n-Math.min(...u.map(y=>y[2]))),this.target=L(s,L(P(l.right,(v-g)/2),P(l.up,(p-x)/2))),this.position=C(this.target,P(l.forward,w))}}function Y(a,t){const e=C(t,a.eye),o=_(e,a.forward),i=a.parallel?a.scale:a.scale/o;return[.5*a.width+i*_(e,a.right),.5*a.height-i*_(e,a.up),o]}const Q=8;function fe(a,t,e){const o=t.map(c=>Math.max(1,Math.ceil(c/Q))),i=o[0]*o[1]*o[2],r=new Float32Array(i).fill(1/0),s=new Float32Array(i).fill(-1/0),n=1/e,l=(c,u)=>[Math.max(0,Math.floor((c-1)/Q)),Math.min(o[u]-1,Math.floor((c+1)/Q))];for(let c=0;c<t[2];++c){const u=l(c,2);for(let h=0;h<t[1];++h){const f=l(h,1),d=t[0]*(h+t[1]*c);for(let m=0;m<o[0];++m){let v=65535,g=0;for(let p=Math.max(0,m*Q-1),x=Math.min(t[0],(m+1)*Q+1);p<x;++p){const w=a[d+p];w<v&&(v=w),w>g&&(g=w)}for(let p=u[0];p<=u[1];++p)for(let x=f[0];x<=f[1];++x){const w=m+o[0]*(x+o[1]*p);v*n<r[w]&&(r[w]=v*n),g*n>s[w]&&(s[w]=g*n)}}}}return{dims:o,lo:r,hi:s}}function de(a,t){const[e,o,i]=a.dims,r=15,s=new Uint8Array(e*o*i);for(let l=0;l<s.length;++l)s[l]=t(a.lo[l],a.hi[l])?0:r;const n=l=>{const c=d=>Array.from({length:d},(m,v)=>l>0?v:d-1-v),u=c(e),h=c(o),f=c(i);for(const d of f)for(const m of h)for(const v of u){const g=v+e*(m+o*d);let p=s[g];if(p!==0){for(let x=-1;x<=1;++x)for(let w=-1;w<=1;++w)for(let y=-1;y<=1;++y){if((x*9+w*3+y)*l>=0)continue;const A=v+y,M=m+w,E=d+x;A<0||M<0||E<0||A>=e||M>=o||E>=i||(p=Math.min(p,s[A+e*(M+o*E)]+1))}s[g]=p}}};return n(1),n(-1),s}const z=`
uniform vec3 uEye, uRight, uUp, uForward;
uniform vec2 uSize;
uniform float uScale, uNear, uFar, uSamples;
uniform bool uParallel;
vec3 toEye(vec3 p) { vec3 d = p - uEye; return vec3(dot(d, uRight), dot(d, uUp), dot(d, uForward)); }
vec4 toClip(vec3 e) {
  vec2 half_ = 0.5 * uSize;
  if (uParallel) return vec4(e.xy * uScale / half_, (2.0 * e.z - uFar - uNear) / (uFar - uNear), 1.0);
  return vec4(e.xy * uScale / half_, ((uFar + uNear) * e.z - 2.0 * uFar * uNear) / (uFar - uNear), e.z);
}
float toDepth(float z) {
  float n = uParallel ? (z - uNear) / (uFar - uNear) : uFar * (z - uNear) / (z * (uFar - uNear));
  return clamp(n, 0.0, 1.0);
}
float fromDepth(float d) {
  return uParallel ? mix(uNear, uFar, d) : uFar * uNear / (uFar - d * (uFar - uNear));
}
vec3 toViewer(vec3 p) { return uParallel ? -uForward : normalize(uEye - p); }
`,Z=`
uniform int uLampCount;
uniform vec4 uLamps[8];
uniform vec4 uMaterial;
vec2 reflectedLight(vec3 n, vec3 view, float power) {
  vec2 sum = vec2(0.0);
  for (int i = 0; i < uLampCount; ++i) {
    float nl = dot(n, uLamps[i].xyz);
    if (!(nl > 0.0)) continue;
    float nh = (nl + dot(n, view)) / sqrt(max(2.0 + 2.0 * dot(uLamps[i].xyz, view), 1e-12));
    sum += uLamps[i].w * vec2(nl, pow(max(nh, 0.0), power));
  }
  return sum;
}
/* Light and gloss of a unit normal on the side that is seen. */
vec2 lightOn(vec3 n, vec3 view) {
  vec2 r = reflectedLight(n, view, uMaterial.w);
  return vec2(uMaterial.x + uMaterial.y * r.x, uMaterial.z * r.y);
}
`,tt=`
uniform sampler2D uTable;
uniform int uTableSize, uScaleKind;
uniform vec4 uBelow, uAbove, uNan;
uniform vec2 uScaleEnds;
float scalePosition(float v) {
  if (uScaleKind == 0) return v;
  float y = uScaleKind == 1 ? log(max(v, 1e-37)) : (abs(v) <= 1.0 ? v : sign(v) * (1.0 + log(abs(v)) / 2.302585093));
  return (y - uScaleEnds.x) / (uScaleEnds.y - uScaleEnds.x);
}
vec4 scaleColor(float v) {
  if (!(abs(v) < 1e30)) return uNan;
  float t = scalePosition(v);
  if (t < -1e-5) return uBelow;
  if (t > 1.00001) return uAbove;
  int i = int(clamp(t, 0.0, 1.0) * float(uTableSize - 1) + 0.5);
  return texelFetch(uTable, ivec2(i & 1023, i >> 10), 0);
}
`,V=`
uniform int uColoring;
uniform vec4 uConstant;
uniform float uOpacity;
vec3 fromSrgb(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(vec3(0.04045), c)); }
`,nt=`
uniform bool uPeeling;
uniform sampler2D uBefore, uHiding;
bool peeledAway(float depth) {
  if (!uPeeling) return false;
  ivec2 at = ivec2(gl_FragCoord.xy);
  return depth <= texelFetch(uBefore, at, 0).r + 1e-7 || depth >= texelFetch(uHiding, at, 0).r;
}
`,me=["composite","maximum","minimum","average","sum","first_hit","distance","accumulate","isosurface","maximum_difference"],pe=`
void main() {
  vec2 p = vec2((gl_VertexID & 1) == 1 ? 3.0 : -1.0, (gl_VertexID & 2) == 2 ? 3.0 : -1.0);
  gl_Position = vec4(p, 0.0, 1.0);
}`,ge=a=>`
#define MODE ${a.mode===9?0:a.mode}
const bool uLit = ${a.lit}, uHasGaps = ${a.gaps}, uNearest = ${a.nearest}, uCells = ${a.cells}, uFast = ${a.fast};
uniform sampler3D uLattice, uDistance, uLeftOut;
uniform sampler2D uMedium, uSums, uFront, uBack;
uniform bool uHasFront;
uniform mat3 uToU;
uniform vec3 uOrigin, uLo, uHi, uDims, uSamplesAlong;
uniform float uStep, uEdge, uPerSurface, uLeast, uMost;
uniform int uLevelCount, uPlaneCount;
const int uMode = MODE;
uniform float uLevels[8];
uniform float uLevelOpacity[8];
uniform vec4 uPlanes[12];
${z}${Z}${tt}
uniform float uScaleLo, uScaleHi, uThreshold;
out vec4 oColor;

const int tableLast = 4095;
vec3 coordinate(vec3 u) { return (u + 0.5) / uSamplesAlong; }
float codeAt(vec3 u) {
  if (uNearest) return texelFetch(uLattice, ivec3(clamp(floor(coordinate(u) * uDims), vec3(0.0), uDims - 1.0)), 0).r;
  return textureLod(uLattice, coordinate(u), 0.0).r;
}
bool gone(vec3 u) {
  if (!uHasGaps) return false;
  vec3 v = coordinate(u) * uDims - 0.5;
  ivec3 cell = uCells ? ivec3(clamp(floor(v + 0.5), vec3(0.0), uDims - 1.0)) : ivec3(clamp(floor(v), vec3(0.0), uDims - 2.0));
  return texelFetch(uLeftOut, cell, 0).r > 0.5;
}
vec4 tableAt(sampler2D table, float code) {
  float x = clamp(code, 0.0, 1.0) * float(tableLast);
  int i = min(int(x), tableLast - 1), j = i + 1;
  return mix(texelFetch(table, ivec2(i & 1023, i >> 10), 0), texelFetch(table, ivec2(j & 1023, j >> 10), 0), x - float(i));
}
vec4 nearestOf(sampler2D table, float code) {
  int i = int(clamp(code, 0.0, 1.0) * float(tableLast) + 0.5);
  return texelFetch(table, ivec2(i & 1023, i >> 10), 0);
}
/* Central differences; in the outermost cells on to the slope that a parabola has at the border. */
float slopeAlong(int a, vec3 t, vec3 h) {
  vec3 e = vec3(0.0);
  e[a] = h[a];
  float v = t[a] * uDims[a] - 0.5, last = uDims[a] - 1.0;
  if (v >= 1.0 && v <= last - 1.0) return 0.5 * (textureLod(uLattice, t + e, 0.0).r - textureLod(uLattice, t - e, 0.0).r);
  if (last < 2.0) {
    t[a] = 0.5 * h[a];
    return textureLod(uLattice, t + e, 0.0).r - textureLod(uLattice, t, 0.0).r;
  }
  bool low = v < 1.0;
  t[a] = low ? 0.5 * h[a] : 1.0 - 0.5 * h[a];
  if (!low) e = -e;
  float f0 = textureLod(uLattice, t, 0.0).r, f1 = textureLod(uLattice, t + e, 0.0).r, f2 = textureLod(uLattice, t + 2.0 * e, 0.0).r;
  float inner = 0.5 * (f2 - f0), border = 2.0 * (f1 - f0) - inner;
  return (low ? 1.0 : -1.0) * mix(border, inner, clamp(low ? v : last - v, 0.0, 1.0));
}
/* Of codes per world length. */
vec3 gradientAt(vec3 u) {
  vec3 voxel = uSamplesAlong / uDims, t = coordinate(u), h = 1.0 / uDims;
  if (uFast) {  /* one-sided: half as many samples */
    vec3 f = vec3(textureLod(uLattice, t + vec3(h.x, 0, 0), 0.0).r, textureLod(uLattice, t + vec3(0, h.y, 0), 0.0).r, textureLod(uLattice, t + vec3(0, 0, h.z), 0.0).r);
    return (f - textureLod(uLattice, t, 0.0).r) / voxel * uToU;
  }
  vec3 g = vec3(slopeAlong(0, t, h), slopeAlong(1, t, h), slopeAlong(2, t, h)) / voxel;
  return g * uToU;
}
/* Light and gloss where the field has a gradient; a weak one is no surface. */
vec2 volumeLight(vec3 g, vec3 direction, bool surface) {
  float l = length(g);
  if (!(l > 0.0)) return vec2(1.0, 0.0);
  float weight = surface ? 1.0 : min(1.0, l * (uMost - uLeast) * uEdge * uPerSurface);
  vec3 n = g * ((dot(g, direction) > 0.0 ? -1.0 : 1.0) / l);
  vec2 light = lightOn(n, -direction);
  return vec2(1.0 + weight * (light.x - 1.0), weight * light.y);
}
float valueOf(float code) { return mix(uLeast, uMost, code); }
/* What scaleColor() takes. */
vec4 colorOfValue(float v) {
  if (uScaleKind == 0) return scaleColor((v - uScaleLo) / (uScaleHi - uScaleLo));
  return scaleColor(uScaleKind == 1 ? v / uScaleLo : v / uThreshold);
}

void main() {
  vec2 p = (gl_FragCoord.xy - 0.5 * uSize) / uScale;
  vec3 from = uEye, direction = uForward + uRight * p.x + uUp * p.y;
  if (uParallel) from += uRight * p.x + uUp * p.y, direction = uForward;
  float per = length(direction);
  direction /= per;
  vec3 o = uToU * (from - uOrigin), d = uToU * direction;
  float t0 = -1e30, t1 = 1e30;
  for (int a = 0; a < 3; ++a) {
    if (abs(d[a]) < 1e-30) { if (o[a] < uLo[a] || o[a] > uHi[a]) t1 = -1e30; continue; }
    float x = (uLo[a] - o[a]) / d[a], y = (uHi[a] - o[a]) / d[a];
    t0 = max(t0, min(x, y)), t1 = min(t1, max(x, y));
  }
  for (int i = 0; i < uPlaneCount; ++i) {
    float along = dot(uPlanes[i].xyz, direction), rest = uPlanes[i].w - dot(uPlanes[i].xyz, from);
    if (along > 0.0) t1 = min(t1, rest / along);
    else if (along < 0.0) t0 = max(t0, rest / along);
    else if (rest < 0.0) t1 = -1e30;
  }
  if (!uParallel) t0 = max(t0, 0.0);
  float enter = t0;
  ivec2 at = ivec2(gl_FragCoord.xy);
  float back = texelFetch(uBack, at, 0).r;
  if (back < 1.0) t1 = min(t1, fromDepth(back) * per);
  if (uHasFront) {
    float front = texelFetch(uFront, at, 0).r;
    if (front >= 1.0) discard;
    t0 = max(t0, front > 0.0 ? fromDepth(front) * per : t0);
  }
  if (!(t1 > t0)) discard;

  vec3 color = vec3(0.0);
  float pass = 1.0, h = uStep, best = 0.0, sum = 0.0, covered = 0.0, highest = 0.0;
  bool found = false, hit = false;
  ivec3 lastBrick = ivec3(-1);
  vec3 texel = uDims / uSamplesAlong;
  const bool skips = uMode == 0 || uMode == 5 || uMode == 8;
  float t = t0, code = codeAt(o + d * t);
#if MODE == 0
  vec2 light = vec2(1.0, 0.0);
  bool lit = false;
  vec4 sums = uFast || uNearest ? vec4(0.0) : tableAt(uSums, code);
#endif
  vec3 perTexel = 1.0 / max(abs(d * texel), vec3(1e-20));
  for (int i = 0; i < 8192; ++i) {
    if (!(t < t1)) break;
    vec3 u = o + d * t;
    if (skips) {
      vec3 v = coordinate(u) * uDims;
      ivec3 brick = ivec3(clamp(floor(v / 8.0), vec3(0.0), vec3(textureSize(uDistance, 0) - 1)));
      float far = brick == lastBrick ? 0.0 : floor(texelFetch(uDistance, brick, 0).r * 255.0 + 0.5);
      lastBrick = brick;
      if (far > 0.0) {
        lastBrick = ivec3(-1);
        vec3 lo = (vec3(brick) - (far - 1.0)) * 8.0, hi = (vec3(brick) + far) * 8.0;
        vec3 room = vec3(d.x > 0.0 ? hi.x - v.x : v.x - lo.x, d.y > 0.0 ? hi.y - v.y : v.y - lo.y, d.z > 0.0 ? hi.z - v.z : v.z - lo.z) * perTexel;
        t += max(min(room.x, min(room.y, room.z)), 0.0) + 1e-3 * h;
        code = codeAt(o + d * t);
#if MODE == 0
        if (!uFast && !uNearest) sums = tableAt(uSums, code);
#endif
        continue;
      }
    }
    float s = min(h, t1 - t);
    vec3 end = o + d * (t + s), middle = o + d * (t + 0.5 * s);
    float next = codeAt(end);
    bool skipped = gone(middle);
#if MODE == 0
    vec4 m, before = sums;
    float change = next - code;
    if (uNearest || uFast) m = nearestOf(uMedium, uNearest ? codeAt(middle) : 0.5 * (code + next)), m.rgb *= m.a;
    else {
      sums = tableAt(uSums, next);
      if (abs(change) > 0.004) m = (sums - before) / change;
      else m = nearestOf(uMedium, 0.5 * (code + next)), m.rgb *= m.a;
    }
    if (m.a > 0.0 && !skipped) {
      float alpha = 1.0 - exp(-m.a * s);
      /* Where little is seen, the light of the sample before will do. */
      if (uLit && (!lit || alpha * pass > (uFast ? 0.02 : 0.0004))) light = volumeLight(gradientAt(middle), direction, false), lit = true;
      color += pass * alpha * (m.rgb / m.a * light.x + light.y);
      pass *= 1.0 - alpha;
      if (pass < (uFast ? 0.02 : 0.002)) break;
    }
#else
    if (skipped) { t += s, code = next; continue; }
    if (uMode == 1 || uMode == 2) {
      float v = uNearest ? codeAt(middle) : uMode == 1 ? max(code, next) : min(code, next);
      if (!found || (uMode == 1 ? v > best : v < best)) best = v, found = true;
    } else if (uMode == 3 || uMode == 4) {
      sum += valueOf(0.5 * (code + next)) * s, covered += s, found = true;
    } else if (uMode == 7) {
      float a = valueOf(code) - uLevels[0], b = valueOf(next) - uLevels[0];
      found = true;
      covered += a >= 0.0 && b >= 0.0 ? s : a >= 0.0 ? s * a / (a - b) : b >= 0.0 ? s * b / (b - a) : 0.0;
    } else {
      /* Crossings of levels, in the order in which they lie. */
      float done = 0.0;
      for (int turn = 0; turn < 8; ++turn) {
        float first = 2.0;
        int which = -1;
        for (int k = 0; k < uLevelCount; ++k) {
          float level = (uLevels[k] - uLeast) / (uMost - uLeast);
          float x = (level - code) / (next - code);
          bool crosses = uMode == 8 ? (code < level) != (next < level) : code >= level || next >= level;
          if (uMode != 8 && code >= level) x = 0.0;
          if (crosses && x >= done && x < first) first = x, which = k;
        }
        if (which < 0) break;
        done = first + 1e-6;
        float low = first, tHit = t + s * low;
        if (uMode == 6) { covered = tHit - enter, found = true, hit = true; break; }
        vec3 place = o + d * tHit;
        vec4 c = colorOfValue(uMode == 8 ? uLevels[which] : valueOf(codeAt(place)));
        vec2 light = uLit ? volumeLight(gradientAt(place), direction, true) : vec2(1.0, 0.0);
        float alpha = uMode == 8 ? clamp(uLevelOpacity[which], 0.0, 1.0) : 1.0;
        color += pass * alpha * (c.rgb * light.x + light.y);
        pass *= 1.0 - alpha;
        if (uMode == 5 || pass < 0.002) { hit = true; break; }
      }
      if (hit) break;
    }
#endif
    t += s, code = next;
  }
#if MODE != 0
  if (found) {
    float v = uMode <= 2 ? valueOf(best) : uMode == 3 ? sum / covered : uMode == 4 ? sum : covered;
    if (uMode == 7 && !(covered > 0.0)) discard;
    bool drawn = uMode <= 2 ? nearestOf(uMedium, best).a > 0.0 : uMode == 3 ? nearestOf(uMedium, (v - uLeast) / (uMost - uLeast)).a > 0.0 : true;
    if (!drawn) discard;
    vec4 c = colorOfValue(v);
    if (!(c.a > 0.0)) discard;
    color = c.rgb, pass = 0.0;
  }
#endif
  if (!(pass < 1.0)) discard;
  oColor = vec4(color, 1.0 - pass);
}`;function et(a,t){if(a.length===0||t!==t)return 0;let e=0;for(;e<a.length&&a[e][0]<=t;)++e;if(e===0)return a[0][1];if(e===a.length)return a[e-1][1];const[o,i]=[a[e-1],a[e]];return o[1]+(i[1]-o[1])*(t-o[0])/(i[0]-o[0])}function xe(a,t,e){let o=Math.max(et(a,t),et(a,e));for(const[i,r]of a)i>=t&&i<=e&&(o=Math.max(o,r));return o}const kt=4096;function ve(a,t,e){const o=kt,i=new Float32Array(4*o),r=new Float32Array(4*o),s=new Uint8Array(o),n=12/a.edge,l=[0,0,0,0];let c=[0,0,0,0];for(let u=0;u<o;++u){const h=a.least+(a.most-a.least)*u/(o-1),f=t.color(h),d=f[3]>0?Math.min(1,Math.max(0,et(e,h))):0,m=Math.min(n,-Math.log1p(-Math.min(d,1-1e-12))/a.unit);i.set([f[0],f[1],f[2],m],4*u);const v=[f[0]*m,f[1]*m,f[2]*m,m];if(u>0)for(let g=0;g<4;++g)l[g]+=.5*(c[g]+v[g])/(o-1);r.set(l,4*u),m>0&&(s[u]=1),c=v}for(const[u,h]of e){const f=Math.floor((u-a.least)/(a.most-a.least)*(o-1));if(h>0)for(const d of[f,f+1])d>=0&&d<o&&(s[d]=1)}return{medium:i,sums:r,seen:s}}function we(a){const t=new Uint32Array(a.length+1);for(let e=0;e<a.length;++e)t[e+1]=t[e]+a[e];return t}const Nt=new Map;function ye(a,t){const e=JSON.stringify(t);let o=Nt.get(e);return o||Nt.set(e,o=new O(a,pe,ge(t))),o}function lt(a,t,e,o,i,r,s){const n=a.createTexture();a.activeTexture(a.TEXTURE0),a.bindTexture(a.TEXTURE_3D,n),a.pixelStorei(a.UNPACK_ALIGNMENT,1),a.texStorage3D(a.TEXTURE_3D,1,e,t[0],t[1],t[2]),a.texSubImage3D(a.TEXTURE_3D,0,0,0,0,t[0],t[1],t[2],o,i,r);for(const[l,c]of[[a.TEXTURE_MIN_FILTER,s],[a.TEXTURE_MAG_FILTER,s],[a.TEXTURE_WRAP_S,a.CLAMP_TO_EDGE],[a.TEXTURE_WRAP_T,a.CLAMP_TO_EDGE],[a.TEXTURE_WRAP_R,a.CLAMP_TO_EDGE]])a.texParameteri(a.TEXTURE_3D,l,c);return n}class ct{constructor(t,e,o,i){this.gl=t,this.info=e,this.scale=o,this.gaps=null,this.space=null,this.medium=null,this.sums=null,this.points=e.opacity.map(([r,s])=>[r,s]),this.origin=C(e.origin,i)}static async load(t,e,o,i,r){const s=new ct(t,e,i[e.scale],o),n=await r.get(e.array),l=e.nearest?t.NEAREST:t.LINEAR;if(e.bits===8)s.values=lt(t,e.dims,t.R8,t.RED,t.UNSIGNED_BYTE,n,l);else{const c=Float32Array.from(n,h=>h/65535),u=t.getExtension("OES_texture_float_linear")||e.nearest;s.values=lt(t,e.dims,u?t.R32F:t.R16F,t.RED,t.FLOAT,c,l)}if(e.left_out!==void 0){const c=e.cells?0:1;s.gaps=lt(t,e.dims.map(u=>u-c),t.R8,t.RED,t.UNSIGNED_BYTE,await r.get(e.left_out),t.NEAREST)}return s.bricks=fe(n,e.dims,e.bits===8?255:65535),s.setOpacity(s.points),s}setOpacity(t){const e=this.gl,o=this.info;this.points=t;const i=ve(o,this.scale,t),r=we(i.seen),s=kt-1;e.deleteTexture(this.medium),e.deleteTexture(this.sums),e.deleteTexture(this.space),this.medium=mt(e,i.medium),this.sums=mt(e,i.sums);const n=o.levels.map(c=>(c-o.least)/(o.most-o.least)),l=(c,u)=>{if(o.mode==="isosurface")return n.some(d=>d>=c&&d<=u);if(o.mode==="first_hit")return u>=n[0];const h=Math.max(0,Math.floor(c*s)-1),f=Math.min(s,Math.ceil(u*s)+1);return r[f+1]>r[h]};this.space=lt(e,this.bricks.dims,e.R8,e.RED,e.UNSIGNED_BYTE,de(this.bricks,l),e.NEAREST)}draw(t,e,o,i){const r=this.gl,s=this.info,n=s.to_u,l=Math.max(0,me.indexOf(s.mode)),c=ye(r,{mode:l,lit:s.lit,gaps:this.gaps!==null,nearest:s.nearest,cells:s.cells,fast:t.moving});c.use(),J(c,t),c.texture("uLattice",0,this.values,r.TEXTURE_3D),c.texture("uDistance",1,this.space,r.TEXTURE_3D),c.texture("uLeftOut",2,this.gaps??this.values,r.TEXTURE_3D),c.texture("uMedium",3,this.medium),c.texture("uSums",4,this.sums),this.scale.bind(c,5),c.texture("uFront",6,e??o),c.texture("uBack",7,o),c.i("uHasFront",e?1:0),r.uniformMatrix3fv(c.place("uToU"),!1,[n[0],n[3],n[6],n[1],n[4],n[7],n[2],n[5],n[8]]),c.f("uOrigin",...this.origin),c.f("uLo",...s.lo),c.f("uHi",...s.hi),c.f("uDims",...s.dims),c.f("uSamplesAlong",...s.samples);const u=Math.max(...s.samples.map((d,m)=>d/s.dims[m]));c.f("uStep",.5*s.edge*u*i),c.f("uEdge",s.edge),c.f("uPerSurface",1/s.surface_from),c.f("uLeast",s.least),c.f("uMost",s.most);const h=s.levels.slice(0,8);c.i("uLevelCount",h.length),h.length&&(r.uniform1fv(c.place("uLevels"),h),r.uniform1fv(c.place("uLevelOpacity"),h.map(d=>et(this.points,d))));const f=[];for(let d=0;d+3<s.clip.length&&f.length<48;d+=4){const m=s.clip.slice(d,d+3);f.push(...m,s.clip[d+3]-(m[0]*t.center[0]+m[1]*t.center[1]+m[2]*t.center[2]))}c.i("uPlaneCount",f.length/4),f.length&&r.uniform4fv(c.place("uPlanes"),f),c.f("uMaterial",...s.material),c.f("uScaleLo",this.scale.info.lo),c.f("uScaleHi",this.scale.info.hi),c.f("uThreshold",this.scale.info.threshold),r.drawArrays(r.TRIANGLES,0,3)}}async function ht(a,t,e){const o=await e.get(a.array),i=new Float32Array(o.length),r=2**a.bits-1,s=[0,1,2].map(l=>a.origin[l]-t[l]+a.lo[l]),n=a.size.map(l=>l/r);for(let l=0;l<o.length;++l)i[l]=s[l%3]+n[l%3]*o[l];return i}async function Rt(a,t){const e=await t.get(a.array),o=2**a.bits-1,i=new Float32Array(e.length/2*3);for(let r=0;r<e.length/2;++r){let s=2*e[2*r]/o-1,n=2*e[2*r+1]/o-1;const l=1-Math.abs(s)-Math.abs(n);if(l<0){const u=(1-Math.abs(n))*(s<0?-1:1);n=(1-Math.abs(s))*(n<0?-1:1),s=u}const c=Math.hypot(s,n,l)||1;i[3*r]=s/c,i[3*r+1]=n/c,i[3*r+2]=l/c}return i}function be(a,t,e,o){const i=2**t-1,r=2**t/16,s=i-r,n=new Float64Array(a.length);for(let l=0;l<a.length;++l){const c=a[l];n[l]=c===0?NaN:c<r?e-e*(c-1)/(r-1):c<=s?(c-r)/(s-r):1+(o-1)*(c-s)/(i-s)}return n}class H{constructor(t,e){this.info=t,this.values=null,this.colors=null,this.perCell=t.kind!=="constant"&&t.per_cell,this.nearest=t.kind==="scale"&&t.nearest,this.scale=t.kind==="scale"?e[t.scale]:null}static async load(t,e,o){const i=new H(t,e);if(t.kind==="direct"&&(i.colors=await o.get(t.colors.array)),t.kind==="scale"){const r=be(await o.get(t.positions.array),t.positions.bits,t.positions.least,t.positions.most);i.values=Float32Array.from(r,s=>i.scale.stored(s))}return i}bind(t,e,o){t.i("uColoring",this.values?1:this.colors?2:0),t.f("uConstant",...this.info.kind==="constant"?this.info.rgba:[1,1,1,1]),t.f("uOpacity",o),this.scale?this.scale.bind(t,e):t.texture("uTable",e,null)}}const Me=`
layout(location=0) in vec3 aFrom;
layout(location=1) in vec3 aTo;
layout(location=2) in vec2 aValues;
layout(location=3) in vec4 aColorFrom;
layout(location=4) in vec4 aColorTo;
layout(location=5) in vec3 aTangentFrom;
layout(location=6) in vec3 aTangentTo;
layout(location=7) in float aRoom;
layout(location=8) in vec3 aPlace;
${z}${V}
uniform float uHalf, uHalo, uWholeFade;
uniform bool uInPixels, uRoomy;
flat out vec3 fA, fB, fFrom, fTo, fTangentFrom, fTangentTo;
flat out vec2 fValues, fPart;
flat out vec4 fColorFrom, fColorTo;
flat out float fFade;
void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  float unit = 1.0;
  if (uInPixels) { float z = toEye(aPlace).z; unit = uSamples * (uParallel ? 1.0 : z) / uScale; }
  vec3 from = aPlace + aFrom * unit, to = aPlace + aTo * unit;
  vec3 a = toEye(from), b = toEye(to);
  fFrom = from, fTo = to, fTangentFrom = aTangentFrom, fTangentTo = aTangentTo, fValues = aValues;
  fColorFrom = vec4(fromSrgb(aColorFrom.rgb), aColorFrom.a), fColorTo = vec4(fromSrgb(aColorTo.rgb), aColorTo.a);
  fFade = 1.0;
  if (uRoomy) {
    float depth = 0.5 * (a.z + b.z), pixels = aRoom * (uParallel ? uScale : uScale / max(depth, 1e-30)) / uSamples;
    fFade = clamp((pixels - 3.0) / 5.0, 0.0, 1.0) * uWholeFade;
    if (!(fFade > 0.0)) return;
  }
  if (a.z < uNear && b.z < uNear) return;
  fPart = vec2(0.0, 1.0);
  if (a.z < uNear) { fPart.x = (uNear - a.z) / (b.z - a.z); a = mix(a, b, fPart.x); }
  else if (b.z < uNear) { fPart.y = (uNear - a.z) / (b.z - a.z); b = mix(a, b, fPart.y); }
  float sa = uParallel ? uScale : uScale / a.z, sb = uParallel ? uScale : uScale / b.z;
  fA = vec3(0.5 * uSize + sa * a.xy, uParallel ? a.z : 1.0 / a.z), fB = vec3(0.5 * uSize + sb * b.xy, uParallel ? b.z : 1.0 / b.z);
  vec2 along = fB.xy - fA.xy;
  float l = length(along), r = uHalf + uHalo + 1.0;
  along = l > 1e-6 ? along / l : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  bool end = (gl_VertexID & 1) == 1, side = (gl_VertexID & 2) == 2;
  vec2 p = (end ? fB.xy + along * r : fA.xy - along * r) + across * (side ? r : -r);
  gl_Position = vec4(p / (0.5 * uSize) - 1.0, 0.0, 1.0);
}`,Te=`
flat in vec3 fA, fB, fFrom, fTo, fTangentFrom, fTangentTo;
flat in vec2 fValues, fPart;
flat in vec4 fColorFrom, fColorTo;
flat in float fFade;
uniform float uHalf, uHalo;
uniform vec3 uHaloColor;
uniform bool uLit, uNearest;
uniform int uContrast, uSoft;
${z}${Z}${tt}${V}${nt}
out vec4 oColor;
/* A thin cylinder (src/render/shade/illuminated.h). */
vec2 lineLight(vec3 tangent, vec3 view) {
  float vt = clamp(dot(view, tangent), -1.0, 1.0), vAcross = sqrt(1.0 - vt * vt);
  vec3 v = view - tangent * vt;
  vec2 sum = vec2(0.0);
  for (int i = 0; i < uLampCount; ++i) {
    vec3 to = uLamps[i].xyz, h = to + view;
    float lt = clamp(dot(to, tangent), -1.0, 1.0), across = sqrt(1.0 - lt * lt);
    float cosine = across * vAcross > 1e-6 ? clamp(dot(to - tangent * lt, v) / (across * vAcross), -1.0, 1.0) : 1.0;
    float angle = acos(cosine), ht = dot(h, tangent) / max(length(h), 1e-9), hAcross = sqrt(max(0.0, 1.0 - ht * ht));
    sum += uLamps[i].w * vec2(across * (sin(angle) + (3.14159265 - angle) * cosine) / 3.14159265, sqrt(0.5 * (1.0 + cosine)) * pow(hAcross, uMaterial.w));
  }
  return vec2(uMaterial.x + uMaterial.y * sum.x, uMaterial.z * sum.y);
}
void main() {
  vec2 q = gl_FragCoord.xy - fA.xy, d = fB.xy - fA.xy;
  float l2 = dot(d, d), t = l2 > 0.0 ? clamp(dot(q, d) / l2, 0.0, 1.0) : 0.0, distance = length(q - t * d);
  /* Of a pixel as wide as the line's own direction across it; 0: whole samples, 1: those that are covered, 2: the others. */
  float share = 1.0;
  if (uSoft == 0 ? distance > uHalf + uHalo : distance > uHalf + uHalo + 0.5) discard;
  if (uSoft != 0) {
    float wide = distance >= uHalf + 0.5 || uHalo == 0.0 ? uHalf + uHalo : uHalf;
    share = clamp(min(distance + 0.5, wide) - max(distance - 0.5, -wide), 0.0, 1.0);
    if ((share >= 0.999) != (uSoft == 1)) discard;
  }
  float w = mix(fA.z, fB.z, t), z = uParallel ? w : 1.0 / w, nearer = 2.0 * (uHalf + 1.0) / uScale;
  float front = uParallel ? z - nearer : z * (1.0 - nearer);
  bool halo = distance > (uSoft == 0 ? uHalf : uHalf + 0.5);
  if (uHalo == 0.0) halo = false;
  if (halo) front = max(front, 0.0) + 2.0 * (uHalf + distance) / uScale * (uParallel ? 1.0 : z);
  gl_FragDepth = toDepth(front);
  if (peeledAway(gl_FragDepth)) discard;
  float s = mix(fPart.x, fPart.y, uParallel ? t : t * fB.z / w);
  vec4 color = uConstant;
  if (uColoring == 1) {
    float v = uNearest ? (s < 0.5 ? fValues.x : fValues.y) : fValues.x == fValues.y ? fValues.x : mix(fValues.x, fValues.y, s);
    color = scaleColor(v);
  }
  if (uColoring == 2) color = mix(fColorFrom, fColorTo, s);
  vec2 light = vec2(1.0, 0.0);
  if (halo) color.rgb = uHaloColor;
  else if (uLit) {
    vec3 tangent = mix(fTangentFrom, fTangentTo, s);
    light = lineLight(normalize(tangent), toViewer(mix(fFrom, fTo, s)));
  }
  color.a *= uOpacity * fFade * share;
  if (!(color.a > 0.0)) discard;
  if (uContrast == 1) { oColor = vec4(0.0, 0.0, 0.0, 0.75 * color.a); return; }
  if (uContrast == 2) { oColor = vec4(vec3(0.1), 0.1) * color.a; return; }
  oColor = vec4((color.rgb * light.x + light.y) * color.a, color.a);
}`;let Ee=null;const Ae=a=>Ee??=new O(a,Me,Te);class vt{constructor(t,e,o,i){this.gl=t,this.look=e,this.coloring=o,this.s=i,this.count=i.from.length/3,this.translucent=e.opacity<1,this.stage=i.room&&!this.translucent?"edges":"marks",this.list=t.createVertexArray(),t.bindVertexArray(this.list);const r=(s,n,l)=>n&&F(t,s,n,l,1);r(0,i.from,3),r(1,i.to,3),r(2,i.values,2),r(5,i.tangentsFrom,3),r(6,i.tangentsTo,3),r(7,i.room,1),r(8,i.places,3),i.colorsFrom&&F(t,3,i.colorsFrom,4,1,t.UNSIGNED_BYTE,!0),i.colorsTo&&F(t,4,i.colorsTo,4,1,t.UNSIGNED_BYTE,!0),t.bindVertexArray(null)}draw(t){const e=this.gl,o=Ae(e),i=this.look,r=this.stage==="edges",s=r?this.wholeFade(t):1;s>0&&(o.use(),J(o,t),this.coloring.bind(o,0,i.opacity),o.f("uMaterial",...i.material),o.f("uHalf",Math.max(.5,.5*i.width*t.samples)),o.f("uHalo",i.halo*t.samples),o.f("uHaloColor",...i.haloColor),o.f("uWholeFade",s),o.i("uLit",i.lit?1:0),o.i("uNearest",this.coloring.nearest?1:0),o.i("uInPixels",i.inPixels?1:0),o.i("uRoomy",this.s.room?1:0),o.i("uContrast",t.peel||i.contrast==="none"?0:i.contrast==="darker"?1:2),r&&(e.enable(e.BLEND),e.blendFunc(e.ONE,e.ONE_MINUS_SRC_ALPHA),e.enable(e.STENCIL_TEST),e.stencilFunc(e.EQUAL,0,255),e.stencilOp(e.KEEP,e.KEEP,e.INCR),e.depthMask(!1)),e.bindVertexArray(this.list),Ct(o,t,r||this.translucent,()=>e.drawArraysInstanced(e.TRIANGLE_STRIP,0,4,this.count)),e.bindVertexArray(null),r&&(e.disable(e.BLEND),e.disable(e.STENCIL_TEST),e.depthMask(!0)))}wholeFade(t){const{from:e,to:o,room:i}=this.s,r=t.projection,s=Math.max(1,Math.floor(this.count/4e3));let n=0,l=0;for(let u=0;u<this.count;u+=s){const h=[0,1].map(m=>{const v=m?o:e;return[0,1,2].reduce((g,p)=>g+(v[3*u+p]+t.center[p]-r.eye[p])*r.forward[p],0)}),f=(r.parallel?r.scale:r.scale/Math.max(.5*(h[0]+h[1]),1e-30))/t.samples,d=Math.hypot(o[3*u]-e[3*u],o[3*u+1]-e[3*u+1],o[3*u+2]-e[3*u+2]);i[u]*f>3?++l:d*f<8&&++n}const c=n/Math.max(1,n+l);return Math.min(1,Math.max(0,(.5-c)/.25))}}function Se(a,t){const e=t.length/2,o=new Float32Array(3*e),i=new Float32Array(3*e),r=new Float32Array(3*e),s=(n,l,c,u,h)=>{const f=Math.hypot(c,u,h)||1;n[3*l]=c/f,n[3*l+1]=u/f,n[3*l+2]=h/f};for(let n=0;n<e;++n){const l=3*t[2*n],c=3*t[2*n+1];s(o,n,a[c]-a[l],a[c+1]-a[l+1],a[c+2]-a[l+2])}for(let n=0;n<e;++n){const l=n>0&&t[2*n-1]===t[2*n]?n-1:n,c=n+1<e&&t[2*n+1]===t[2*n+2]?n+1:n;s(i,n,o[3*l]+o[3*n],o[3*l+1]+o[3*n+1],o[3*l+2]+o[3*n+2]),s(r,n,o[3*c]+o[3*n],o[3*c+1]+o[3*n+1],o[3*c+2]+o[3*n+2])}return[i,r]}async function Fe(a,t,e,o,i){const r=await H.load(t.color,o,i),s=await ht(t.positions,e,i),n=await i.get(t.segments),l=n.length/2,c={from:new Float32Array(3*l),to:new Float32Array(3*l)};for(let h=0;h<l;++h)for(let f=0;f<3;++f)c.from[3*h+f]=s[3*n[2*h]+f],c.to[3*h+f]=s[3*n[2*h+1]+f];const u=(h,f)=>r.perCell?h:n[2*h+f];if(r.values&&(c.values=Float32Array.from({length:2*l},(h,f)=>r.values[u(f>>1,f&1)])),r.colors){c.colorsFrom=new Uint8Array(4*l),c.colorsTo=new Uint8Array(4*l);for(let h=0;h<l;++h)for(let f=0;f<4;++f)c.colorsFrom[4*h+f]=r.colors[4*u(h,0)+f],c.colorsTo[4*h+f]=r.colors[4*u(h,1)+f]}return t.lit&&([c.tangentsFrom,c.tangentsTo]=Se(s,n)),t.room!==void 0&&(c.room=await i.get(t.room)),new vt(a,{width:t.width,opacity:t.opacity,lit:t.lit,material:t.material,contrast:t.contrast,halo:t.halo,haloColor:t.halo_color,inPixels:!1},r,c)}const Ce=`
layout(location=0) in vec3 aPlace;
layout(location=1) in vec3 aNormal;
layout(location=2) in float aValue;
layout(location=3) in vec4 aColor;
layout(location=4) in vec3 aValues;
${z}${V}
out vec3 vPlace, vNormal, vValues, vCorner;
out float vValue;
out vec4 vColor;
void main() {
  vPlace = aPlace, vNormal = aNormal, vValue = aValue, vValues = aValues;
  vCorner = vec3(gl_VertexID % 3 == 0, gl_VertexID % 3 == 1, gl_VertexID % 3 == 2);
  vColor = vec4(fromSrgb(aColor.rgb), aColor.a);
  gl_Position = toClip(toEye(aPlace));
}`,Dt=`
uniform bool uLit, uSmooth;
out vec4 oColor;
void shadeSurface(vec3 place, vec3 normal, vec4 color) {
  color.a *= uOpacity;
  if (!(color.a > 0.0) || peeledAway(gl_FragCoord.z)) discard;
  vec2 light = vec2(1.0, 0.0);
  if (uLit) {
    vec3 view = toViewer(place), face = cross(dFdx(place), dFdy(place));
    float l = length(face);
    face = l > 0.0 ? face / l : view;
    if (dot(face, view) < 0.0) face = -face;
    vec3 n = face;
    if (uSmooth && dot(normal, normal) > 1e-20) {
      n = normalize(normal);
      if (dot(n, face) < 0.0) n = -n;
    }
    light = lightOn(n, view);
  }
  oColor = vec4((color.rgb * light.x + light.y) * color.a, color.a);
}`,Pe=`
in vec3 vPlace, vNormal, vValues, vCorner;
in float vValue;
in vec4 vColor;
uniform bool uNearest;
${z}${Z}${tt}${V}${nt}${Dt}
void main() {
  vec4 color = uConstant;
  float value = vValue;
  if (uNearest) value = vCorner.x >= vCorner.y && vCorner.x >= vCorner.z ? vValues.x : vCorner.y >= vCorner.z ? vValues.y : vValues.z;
  if (uColoring == 1) color = scaleColor(value);
  if (uColoring == 2) color = vColor;
  shadeSurface(vPlace, vNormal, color);
}`;let _e=null;const Le=a=>_e??=new O(a,Ce,Pe);function ot(a,t,e){const o=new a.constructor(t.length*e);for(let i=0;i<t.length;++i)for(let r=0;r<e;++r)o[e*i+r]=a[e*t[i]+r];return o}class wt{constructor(t,e,o){this.gl=t,this.info=e,this.coloring=o,this.stage="surface",this.count=0,this.indexed=!1,this.smooth=!1,this.translucent=e.translucent,this.list=t.createVertexArray()}static async load(t,e,o,i,r){const s=await H.load(e.color,i,r),n=new wt(t,e,s);let l=await ht(e.positions,o,r);const c=await r.get(e.triangles);let u=e.normals?await Rt(e.normals,r):null,h=s.values,f=s.colors;const d=e.corners!==void 0||s.perCell||s.nearest;let m=null;if(d){l=ot(l,c,3),u&&(u=ot(u,e.corners!==void 0?await r.get(e.corners):c,3));const v=s.perCell?Uint32Array.from(c,(g,p)=>Math.floor(p/3)):c;h&&(h=ot(h,v,1)),f&&(f=ot(f,v,4)),h&&s.nearest&&(m=ot(h,Uint32Array.from({length:3*h.length},(g,p)=>Math.floor(p/9)*3+p%3),1))}return t.bindVertexArray(n.list),F(t,0,l,3),u&&F(t,1,u,3),h&&F(t,2,h,1),f&&F(t,3,f,4,0,t.UNSIGNED_BYTE,!0),m&&F(t,4,m,3),d||(t.bindBuffer(t.ELEMENT_ARRAY_BUFFER,t.createBuffer()),t.bufferData(t.ELEMENT_ARRAY_BUFFER,c,t.STATIC_DRAW)),t.bindVertexArray(null),n.indexed=!d,n.count=c.length,n.smooth=u!==null,h&&(s.values=new Float32Array(0)),f&&(s.colors=new Uint8Array(0)),n}draw(t){const e=this.gl,o=Le(e);o.use(),J(o,t),this.coloring.bind(o,0,this.info.opacity),o.f("uMaterial",...this.info.material),o.i("uLit",this.info.lit?1:0),o.i("uSmooth",this.smooth?1:0),o.i("uNearest",this.coloring.nearest&&!this.coloring.perCell?1:0),e.bindVertexArray(this.list),this.indexed?e.drawElements(e.TRIANGLES,this.count,e.UNSIGNED_INT,0):e.drawArrays(e.TRIANGLES,0,this.count),e.bindVertexArray(null)}}const ke=`
layout(location=0) in vec3 aPoint;
layout(location=1) in vec3 aNormal;
layout(location=2) in float aValue;
layout(location=3) in vec4 aColor;
layout(location=4) in vec3 aPlace;
layout(location=5) in vec3 aRow0;
layout(location=6) in vec3 aRow1;
layout(location=7) in vec3 aRow2;
${z}${V}
uniform bool uInPixels;
out vec3 vPlace, vNormal;
flat out float fValue;
flat out vec4 fColor;
void main() {
  float unit = 1.0;
  if (uInPixels) unit = uSamples * (uParallel ? 1.0 : toEye(aPlace).z) / uScale;
  vPlace = aPlace + unit * vec3(dot(aRow0, aPoint), dot(aRow1, aPoint), dot(aRow2, aPoint));
  // Normals turn with the cofactors of the matrix.
  vNormal = vec3(dot(cross(aRow1, aRow2), aNormal), dot(cross(aRow2, aRow0), aNormal), dot(cross(aRow0, aRow1), aNormal));
  float l = length(vNormal);
  vNormal = l > 0.0 ? vNormal / l : aNormal;
  fValue = aValue, fColor = vec4(fromSrgb(aColor.rgb), aColor.a);
  gl_Position = toClip(toEye(vPlace));
}`,Ne=`
in vec3 vPlace, vNormal;
flat in float fValue;
flat in vec4 fColor;
${z}${Z}${tt}${V}${nt}${Dt}
void main() {
  shadeSurface(vPlace, vNormal, uColoring == 1 ? scaleColor(fValue) : uColoring == 2 ? fColor : uConstant);
}`;let Re=null;function De(a,t,e){const o=[];for(let i=0;i<e;++i)(t?t[i]:0)===a&&o.push(i);return Uint32Array.from(o)}function at(a,t,e){const o=new a.constructor(t.length*e);return t.forEach((i,r)=>{for(let s=0;s<e;++s)o[e*r+s]=a[e*i+s]}),o}class yt{constructor(t,e,o){this.gl=t,this.info=e,this.coloring=o,this.stage="surface",this.lists=[],this.translucent=e.translucent}static async load(t,e,o,i,r){const s=await H.load(e.color,i,r),n=await ht(e.places,o,r),l=await r.get(e.matrices),c=n.length/3,u=new Float32Array(l.length);for(let m=0;m<l.length;++m)u[m]=(l[m]-32767)*e.largest;const h=e.choice!==void 0?await r.get(e.choice):null,f=await Promise.all(e.shapes.map(async m=>({points:await r.get(m.positions),normals:m.normals!==void 0?await r.get(m.normals):null})));if(e.kind==="glyph_lines")return ze(t,e,s,n,u,f.map(m=>m.points),h);const d=new yt(t,e,s);return f.forEach((m,v)=>{const g=De(v,h,c);if(g.length===0||m.points.length===0)return;const p=t.createVertexArray(),x=at(u,g,9);t.bindVertexArray(p),F(t,0,m.points,3),m.normals&&F(t,1,m.normals,3),s.values&&F(t,2,at(s.values,g,1),1,1),s.colors&&F(t,3,at(s.colors,g,4),4,1,t.UNSIGNED_BYTE,!0),F(t,4,at(n,g,3),3,1);for(let w=0;w<3;++w)F(t,5+w,at(x,Uint32Array.from(g,(y,b)=>3*b+w),3),3,1);t.bindVertexArray(null),d.lists.push({list:p,corners:m.points.length/3,count:g.length})}),d}draw(t){const e=this.gl,o=Re??=new O(e,ke,Ne);o.use(),J(o,t),this.coloring.bind(o,0,this.info.opacity),o.f("uMaterial",...this.info.material),o.i("uLit",this.info.lit?1:0),o.i("uSmooth",1),o.i("uInPixels",this.info.in_pixels?1:0);for(const{list:i,corners:r,count:s}of this.lists)e.bindVertexArray(i),e.drawArraysInstanced(e.TRIANGLES,0,r,s);e.bindVertexArray(null)}}function ze(a,t,e,o,i,r,s){const n=o.length/3;let l=0;for(let h=0;h<n;++h)l+=r[s?s[h]:0].length/6;const c={from:new Float32Array(3*l),to:new Float32Array(3*l),places:new Float32Array(3*l)};e.values&&(c.values=new Float32Array(2*l)),e.colors&&(c.colorsFrom=new Uint8Array(4*l),c.colorsTo=new Uint8Array(4*l));let u=0;for(let h=0;h<n;++h){const f=r[s?s[h]:0];for(let d=0;d<f.length/6;++d,++u){for(let m=0;m<3;++m){for(const[v,g]of[[c.from,6*d],[c.to,6*d+3]])v[3*u+m]=[0,1,2].reduce((p,x)=>p+i[9*h+3*m+x]*f[g+x],0);c.places[3*u+m]=o[3*h+m]}if(c.values&&(c.values[2*u]=c.values[2*u+1]=e.values[h]),c.colorsFrom)for(const m of[c.colorsFrom,c.colorsTo])m.set(e.colors.subarray(4*h,4*h+4),4*u)}}return new vt(a,{width:t.width,opacity:t.opacity,lit:!1,material:t.material,contrast:"none",halo:0,haloColor:[0,0,0],inPixels:t.in_pixels},e,c)}const Ie=`
layout(location=0) in vec3 aPlace;
layout(location=1) in vec3 aNormal;
layout(location=2) in float aValue;
layout(location=3) in vec4 aColor;
layout(location=4) in float aRadius;
${z}${V}
uniform float uHalf;
uniform bool uDiscs;
out vec2 vAt;
flat out vec3 fNormal, fPlace;
flat out float fValue, fDepth;
flat out vec4 fColor;
out vec3 vPlace;
void main() {
  vec2 corner = vec2((gl_VertexID & 1) == 1 ? 1.0 : -1.0, (gl_VertexID & 2) == 2 ? 1.0 : -1.0);
  fValue = aValue, fColor = vec4(fromSrgb(aColor.rgb), aColor.a), fNormal = aNormal, fPlace = aPlace, vPlace = aPlace, fDepth = 0.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (uDiscs) {
    vec3 a = normalize(cross(aNormal, abs(aNormal.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0))), b = cross(aNormal, a);
    vPlace = aPlace + (a * corner.x + b * corner.y) * aRadius;
    vAt = corner;
    gl_Position = toClip(toEye(vPlace));
    return;
  }
  vec3 e = toEye(aPlace);
  if (e.z < uNear) return;
  float nearer = 2.0 * (uHalf + 1.0) / uScale, s = uParallel ? uScale : uScale / e.z, r = uHalf + 1.0;
  fDepth = toDepth(uParallel ? e.z - nearer : e.z * (1.0 - nearer));
  vAt = corner * r / uHalf;
  gl_Position = vec4((s * e.xy + corner * r) / (0.5 * uSize), 2.0 * fDepth - 1.0, 1.0);
}`,Oe=`
in vec2 vAt;
in vec3 vPlace;
flat in vec3 fNormal, fPlace;
flat in float fValue, fDepth;
flat in vec4 fColor;
uniform bool uDiscs, uLit;
uniform int uSoft;
uniform float uHalf;
${z}${Z}${tt}${V}${nt}
out vec4 oColor;
void main() {
  float r2 = dot(vAt, vAt), share = 1.0;
  if (uDiscs || uSoft == 0) {
    if (r2 > 1.0) discard;
  } else {
    float distance = sqrt(r2) * uHalf;
    share = clamp(min(distance + 0.5, uHalf) - max(distance - 0.5, -uHalf), 0.0, 1.0);
    if (!(share > 0.0) || (share >= 0.999) != (uSoft == 1)) discard;
  }
  if (peeledAway(gl_FragCoord.z)) discard;
  vec4 color = uColoring == 1 ? scaleColor(fValue) : uColoring == 2 ? fColor : uConstant;
  color.a *= uOpacity * share;
  if (!(color.a > 0.0)) discard;
  vec2 light = vec2(1.0, 0.0);
  if (uDiscs) {
    vec3 view = toViewer(vPlace), n = fNormal;
    light = lightOn(dot(n, view) < 0.0 ? -n : n, view);
  } else if (uLit) {
    light = lightOn(normalize(uRight * vAt.x + uUp * vAt.y - uForward * sqrt(max(0.0, 1.0 - r2))), -uForward);
  }
  oColor = vec4((color.rgb * light.x + light.y) * color.a, color.a);
}`;let Ue=null;class bt{constructor(t,e,o){this.gl=t,this.info=e,this.coloring=o,this.stage="marks",this.count=0,this.translucent=e.opacity<1,this.list=t.createVertexArray()}static async load(t,e,o,i,r){const s=new bt(t,e,await H.load(e.color,i,r)),n=await ht(e.positions,o,r),l=e.normals?await Rt(e.normals,r):null,c=e.radii!==void 0?await r.get(e.radii):null;return t.bindVertexArray(s.list),F(t,0,n,3,1),l&&F(t,1,l,3,1),s.coloring.values&&F(t,2,s.coloring.values,1,1),s.coloring.colors&&F(t,3,s.coloring.colors,4,1,t.UNSIGNED_BYTE,!0),c&&F(t,4,c,1,1),t.bindVertexArray(null),s.count=n.length/3,s}draw(t){const e=this.gl,o=Ue??=new O(e,Ie,Oe);o.use(),J(o,t),this.coloring.bind(o,0,this.info.opacity),o.f("uMaterial",...this.info.material),o.f("uHalf",Math.max(.5,.5*this.info.size*t.samples)),o.i("uDiscs",this.info.kind==="discs"?1:0),o.i("uLit",this.info.lit?1:0),e.bindVertexArray(this.list),Ct(o,t,this.translucent||this.info.kind==="discs",()=>e.drawArraysInstanced(e.TRIANGLE_STRIP,0,4,this.count)),e.bindVertexArray(null)}}function ut(a,t){for(let e=0;e<3;++e)a.lo[e]=Math.min(a.lo[e],t[e]),a.hi[e]=Math.max(a.hi[e],t[e])}function Be(a,t){if(t.kind==="volume"){const i=t.to_u,r=i[0]*(i[4]*i[8]-i[5]*i[7])-i[1]*(i[3]*i[8]-i[5]*i[6])+i[2]*(i[3]*i[7]-i[4]*i[6]),s=[i[4]*i[8]-i[5]*i[7],i[2]*i[7]-i[1]*i[8],i[1]*i[5]-i[2]*i[4],i[5]*i[6]-i[3]*i[8],i[0]*i[8]-i[2]*i[6],i[2]*i[3]-i[0]*i[5],i[3]*i[7]-i[4]*i[6],i[1]*i[6]-i[0]*i[7],i[0]*i[4]-i[1]*i[3]].map(n=>n/r);for(let n=0;n<8;++n){const l=ne(s,B({lo:t.lo,hi:t.hi},n));ut(a,[l[0]+t.origin[0],l[1]+t.origin[1],l[2]+t.origin[2]])}return}const e="places"in t?t.places:t.positions,o="places"in t&&!t.in_pixels?t.largest*32767:0;for(let i=0;i<8;++i)ut(a,[0,1,2].map(r=>e.origin[r]+e.lo[r]+(i>>r&1?e.size[r]+o:-o)))}const zt=a=>a.box?{lo:a.box.slice(0,3),hi:a.box.slice(3)}:null;function It(a,t){const e={lo:[1/0,1/0,1/0],hi:[-1/0,-1/0,-1/0]},o=zt(t);o&&(ut(e,o.lo),ut(e,o.hi));for(const i of a)Be(e,i);return e.lo[0]<=e.hi[0]?e:{lo:[-.5,-.5,-.5],hi:[.5,.5,.5]}}async function Ve(a,t,e,o,i,r){const{items:s,annotation:n,time:l}=t.steps[e],c=[],u=[],h=await Promise.all(s.map(f=>{switch(f.kind){case"surface":return wt.load(a,f,o,i,r);case"lines":return Fe(a,f,o,i,r);case"points":case"discs":return bt.load(a,f,o,i,r);case"volume":return ct.load(a,f,o,i,r);default:return yt.load(a,f,o,i,r)}}));for(const f of h)f instanceof ct?c.push(f):u.push(f);return{annotation:n,box:zt(n),bounds:It(s,n),drawables:u,volumes:c,time:l}}class $e{constructor(t,e,o){this.gl=t,this.box=e,this.center=o,this.key=-1,this.lines=null,this.coloring=null}async load(t){this.coloring=await H.load({kind:"constant",rgba:[.4341536,.4341536,.462077,1]},[],t)}at(t){const e=(s,n)=>t.parallel?(n?-1:1)*-t.forward[s]>=0:n?t.eye[s]<=this.box.hi[s]:t.eye[s]>=this.box.lo[s];let o=0;for(let s=0;s<3;++s)o|=(e(s,!1)?1<<2*s:0)|(e(s,!0)?2<<2*s:0);if(o===this.key||!this.coloring)return this.lines;const i=[],r=[];for(let s=0;s<8;++s)for(let n=0;n<3;++n){const l=(n+1)%3,c=(n+2)%3;s>>n&1||!(this.box.hi[n]>this.box.lo[n])||!e(l,(s>>l&1)===1)&&!e(c,(s>>c&1)===1)||(i.push(...C(B(this.box,s),this.center)),r.push(...C(B(this.box,s|1<<n),this.center)))}return this.key=o,this.lines=i.length===0?null:new vt(this.gl,{width:1,opacity:1,lit:!1,material:[1,0,0,1],contrast:"none",halo:0,haloColor:[0,0,0],inPixels:!1},this.coloring,{from:Float32Array.from(i),to:Float32Array.from(r)}),this.lines}}const $=(a,t)=>a.x<t.x+t.width&&t.x<a.x+a.width&&a.y<t.y+t.height&&t.y<a.y+a.height,j=(a,t)=>({x:a.x-t,y:a.y-t,width:a.width+2*t,height:a.height+2*t}),Ot=(a,t)=>Math.max(432,Math.min(t,.8*a));function He(a,t,e){const o=Ot(t,e)/Ot(a.width,a.height),[i,r,s,n]=a.area,l=Math.round(i*o),c=Math.round(r*o),u=Math.round((a.width-i-s)*o),h=Math.round((a.height-r-n)*o),f=(l+u)*2>t,d=(c+h)*2>e,m={x:f?0:l,y:d?0:c,width:Math.max(1,f?t:t-l-u),height:Math.max(1,d?e:e-c-h)};return{width:t,height:e,factor:o,area:m}}function Ut(a,t,e,o){return o.parallel?(e?-1:1)*o.forward[t]>1e-9:e?o.eye[t]>a.hi[t]:o.eye[t]<a.lo[t]}function je(a,t){const e=[],o=[0,0],i=[];for(let r=0;r<8;++r){const s=Y(t,B(a,r));if(!t.parallel&&!(s[2]>0))return i;e.push([s[0],s[1]]),o[0]+=s[0]/8,o[1]+=s[1]/8}for(let r=0;r<3;++r){const s=(r+1)%3,n=(r+2)%3;let l=-1/0,c=null;for(let u=0;u<4;++u){const h=(u&1)===1,f=(u&2)===2;if(Ut(a,s,h,t)===Ut(a,n,f,t))continue;const d=(h?1<<s:0)|(f?1<<n:0),m=d|1<<r,v=[e[m][0]-e[d][0],e[m][1]-e[d][1]],g=Math.hypot(...v);if(g<24)continue;const p=[.5*(e[d][0]+e[m][0])-o[0],.5*(e[d][1]+e[m][1])-o[1]];let x=[v[1]/g,-v[0]/g];x[0]*p[0]+x[1]*p[1]<0&&(x=[-x[0],-x[1]]);const w=.85*x[1]-.5*x[0];w>l&&(l=w,c={axis:r,from:B(a,d),to:B(a,m),outward:x})}c&&i.push(c)}return i}function Mt(a,t,e,o){const i=Math.abs(t[0])*.5*e+Math.abs(t[1])*.5*o;return{x:a[0]+t[0]*i-.5*e,y:a[1]+t[1]*i-.5*o,width:e,height:o}}function Ge(a,t,e,o,i,r){if(!t.axes||!t.axis)return;const s=h=>h.x>=2&&h.y>=2&&h.x+h.width<=o.width-2&&h.y+h.height<=o.height-2&&!r.some(f=>$(f,h)),n=.88*i,l=Math.max(1,.08*i),c=je(e,o).map(h=>{const f=Y(o,h.from),d=Y(o,h.to),m=Math.hypot(d[0]-f[0],d[1]-f[1]);let v=[];for(let g=Math.floor(Math.max(2,Math.min(7,m/(3.5*i))));g>=1;--g){let p=!0;v=[];for(const x of t.axis[h.axis].ticks[g-1]){const w=[...h.from];w[h.axis]=x.at;const y=Y(o,w),b=a.measure(x.text,{size:n}),A=[y[0],y[1]],M=Mt([A[0]+h.outward[0]*.85*i,A[1]+h.outward[1]*.85*i],h.outward,b.width,b.height);p=p&&!v.some(E=>$(j(E.rect,.12*i),M)),v.push({at:A,text:x.text,rect:M})}if(p)break}return{axis:h,ticks:v,from:f,to:d}});for(const h of c){const f=t.axis[h.axis.axis].name;if(!f)continue;const d=[...r,...c.filter(b=>b!==h).flatMap(b=>b.ticks.map(A=>j(A.rect,1)))],m=[.5*(h.from[0]+h.to[0]),.5*(h.from[1]+h.to[1])],v=[h.to[0]-h.from[0],h.to[1]-h.from[1]],g=h.axis.outward,p=(b,A)=>{let M=.9*i;for(const E of h.ticks){const k=E.rect.x+.5*E.rect.width,S=E.rect.y+.5*E.rect.height,K=Math.abs(g[0])*.5*E.rect.width+Math.abs(g[1])*.5*E.rect.height;M=Math.max(M,(k-E.at[0])*g[0]+(S-E.at[1])*g[1]+K+.85*i)}for(const E of[M,M*.75,M*.5,M*1.4])for(const k of[0,.1,-.1,.2,-.2,.3,-.3,.42,-.42,.5,-.5]){const S=Mt([m[0]+v[0]*k+g[0]*E,m[1]+v[1]*k+g[1]*E],g,b,A),K={x:S.x-.8*i,y:S.y-.3*i,width:S.width+1.6*i,height:S.height+.6*i};if(!(h.ticks.some(G=>$(G.rect,K))||d.some(G=>$(G,S)))&&S.x>=2&&S.y>=2&&S.x+S.width<=o.width-2&&S.y+S.height<=o.height-2)return S}return null},x=a.measure(f,{size:i});let w=p(x.width,x.height);if((!w||w.x<.6*i||w.x+w.width>o.width-.6*i)&&Math.abs(v[1])>3*Math.abs(v[0])){const b=p(x.height,x.width);if(b){a.turned(f,b.x+.5*b.width,b.y+.5*b.height,Math.PI/2,{size:i,halo:!0}),r.push(b);continue}}w&&(a.text(f,w.x,w.y,{size:i,halo:!0}),r.push(w))}const u=[];for(const h of c){const f=h.axis.outward,d=[];a.line(h.from[0],h.from[1],h.to[0],h.to[1],l,a.ink,.9);const m=Math.hypot(h.to[0]-h.from[0],h.to[1]-h.from[1])||1,v=[(h.to[0]-h.from[0])/m,(h.to[1]-h.from[1])/m];for(const g of h.ticks){a.line(g.at[0],g.at[1],g.at[0]+f[0]*.5*i,g.at[1]+f[1]*.5*i,l,a.ink,.9);const p=((g.at[0]-h.from[0])*v[0]+(g.at[1]-h.from[1])*v[1])/m,x=Math.abs(p-.5)<.25?[0,0]:p<.5?v:[-v[0],-v[1]],w=[[0,0],[x[0]*.45,x[1]*.45],[x[0]*.9,x[1]*.9],[f[0]*.4+x[0]*.6,f[1]*.4+x[1]*.6],[f[0]*.8,f[1]*.8],[f[0]*1.2,f[1]*1.2],[-.7,.1],[.7,.1],[-1.4,.3],[1.4,.3],[f[0]*1.7,f[1]*1.7]];for(const y of w){const b={...g.rect,x:g.rect.x+y[0]*i,y:g.rect.y+y[1]*i},A={x:b.x-.7*i,y:b.y-.15*i,width:b.width+1.4*i,height:b.height+.3*i};if(!(!s(j(b,.3*i))||u.some(M=>$(M,A)))){a.text(g.text,b.x,b.y,{size:n,halo:!0}),r.push(b),d.push(b);break}}}u.push(...d)}}const Xe=["rgb(255 107 97)","rgb(115 217 102)","rgb(115 158 255)"],qe=["rgb(204 38 38)","rgb(26 133 38)","rgb(31 82 204)"];function Bt(a,t){const e=7.6000000000000005*t;return{x:.6*t,y:a-e-.6*t,width:e,height:e}}function We(a,t,e,o){const i=Bt(e.height,o),r=i.x+.5*i.width,s=i.y+.5*i.height,n=[0,1,2].map(c=>{const u=[0,0,0];return u[c]=t.stretch[c]<0?-1:1,{axis:c,d:[_(u,e.right),-_(u,e.up)],depth:_(u,e.forward)}}).sort((c,u)=>u.depth-c.depth),l=[n.reduce((c,u)=>c+u.d[0],0),n.reduce((c,u)=>c+u.d[1],0)];for(const c of n){const u=(t.dark?Xe:qe)[c.axis],h=Math.hypot(...c.d),f=[r+c.d[0]*2.7*o,s+c.d[1]*2.7*o];let d;if(h>.05){d=[c.d[0]/h,c.d[1]/h];const x=Math.min(.75*o,.8*h*2.7*o),w=[f[0]-d[0]*x,f[1]-d[1]*x],y=.3*o;a.line(r,s,w[0],w[1],Math.max(1.5,.16*o),u),a.polygon([f,[w[0]-d[1]*y,w[1]+d[0]*y],[w[0]+d[1]*y,w[1]-d[0]*y]],u)}else{const x=a.context,w=Math.hypot(...l);x.fillStyle=u,x.beginPath(),x.arc(r,s,.28*o,0,2*Math.PI),x.fill(),d=w>.05?[-l[0]/w,-l[1]/w]:[-.7071,.7071]}const m=t.axis?.[c.axis].letter??"xyz"[c.axis];if(!m||m.length>3)continue;const v=a.measure(m,{size:o,bold:!0}),g=h>.05?f:[r+d[0]*.25*o,s+d[1]*.25*o],p=Mt([g[0]+d[0]*.05*o,g[1]+d[1]*.05*o],d,v.width,v.height);a.text(m,p.x,p.y,{size:o,bold:!0,color:u})}}class Ye{constructor(t,e,o){this.l=t,this.a=e,this.at=o}x(t){const{factor:e,width:o}=this.at;return this.l.place==="right"?o-(this.a.width-t)*e:this.l.place==="left"?t*e:.5*o+(t-.5*this.a.width)*e}y(t){const{factor:e,height:o}=this.at;return this.l.place==="top"?t*e:this.l.place==="bottom"?o-(this.a.height-t)*e:.5*o+(t-.5*this.a.height)*e}rect(t){const e=Math.round(this.x(t[0])),o=Math.round(this.y(t[1])),i=this.at.factor;return{x:e,y:o,width:Math.round(t[2]*i),height:Math.round(t[3]*i)}}length(t){return t*this.at.factor}}const I=(a,t,e,o,i,r)=>{t[3]!==0&&(a.fillStyle=X(t),a.fillRect(e,o,i,r))};function Ke(a,t,e,o,i,r){const s=new Ye(t,e,o),n=s.length(t.font);if(t.title){const l={size:s.length(t.title_size),wrap:s.length(t.title_wrap),centred:t.title_centred};if(t.title_upwards){const[c,u]=t.title_extent;a.turned(t.title,s.x(t.title_at[0]+.5*u),s.y(t.title_at[1]+.5*c),Math.PI/2,{...l,halo:!0})}else a.text(t.title,s.x(t.title_at[0]),s.y(t.title_at[1]),{...l,halo:!0})}if(t.colors?Je(a,t,s,n):Qe(a,t,s,n),t.panel&&t.scale!==void 0&&Ze(a,t,s,n,i[t.scale],r??t.opacity??[]),t.glyph&&to(a,t,s,n),t.nan){const l=Math.round(s.x(t.nan_at[0])),c=Math.round(s.y(t.nan_at[1])),u=Math.round(1.3*n);I(a.context,t.nan_color,l,c,u,Math.round(.9*n)),a.frame(l,c,u,Math.round(.9*n)),a.text("NaN",l+u+.75*n,c-.15*n,{size:n,halo:!0})}return s.rect(t.column)}function Je(a,t,e,o){const i=a.context,r=e.rect(t.bar),s=t.colors,n=t.place==="top"||t.place==="bottom",l=n?r.width:r.height,c=s.length/4;for(let y=0;y<l;++y){const b=4*Math.min(c-1,l===c?y:Math.round(y/Math.max(1,l-1)*(c-1))),A=s.slice(b,b+4);n?I(i,A,r.x+y,r.y,1,r.height):I(i,A,r.x,r.y+y,r.width,1)}a.frame(r.x,r.y,r.width,r.height);const u=r.x+r.width,h=r.y+r.height,f=o,d=r.x+.5*r.width,m=r.y+.5*r.height;t.above&&a.polygon(n?[[u+2,r.y],[u+2+f,m],[u+2,h]]:[[r.x,r.y-2],[d,r.y-2-f],[u,r.y-2]],X(t.above),!0),t.below&&a.polygon(n?[[r.x-2,r.y],[r.x-2-f,m],[r.x-2,h]]:[[r.x,h+2],[d,h+2+f],[u,h+2]],X(t.below),!0);const v=Math.max(1,.07*o),g=.5*a.measure("0",{size:o}).height,[p,x]=[t.bar[0],t.bar[1]],w=Math.max(1,c-1);for(const y of t.ticks){const b=(y.at-(n?p:x))/w,A=(n?r.x:r.y)+Math.round(b*(l-1))+.5;n?(a.line(A,h,A,h+.35*o,v,a.ink,.9),a.text(y.text,A-.5*a.measure(y.text,{size:o}).width,h+.45*o,{size:o,halo:!0})):(a.line(u,A,u+.35*o,A,v,a.ink,.9),a.text(y.text,u+.75*o,A-g,{size:o,halo:!0}))}}function Qe(a,t,e,o){const i=e.rect(t.bar),r=e.length(t.row_height),s=e.length(t.row_width),n=Math.round(1.3*o);t.rows.forEach((l,c)=>{const u=i.x+c%t.across*s,h=i.y+Math.floor(c/t.across)*r;if(c<t.swatches.length){const f=Math.round(h+.12*r),d=Math.round(.76*r);I(a.context,t.swatches[c],Math.round(u),f,n,d),a.frame(Math.round(u),f,n,d)}a.text(l,u+(c<t.swatches.length?n+.6*o:0),h+.5*(r-1.164*o),{size:o,halo:!0,wrap:12*o,cut:!0})})}function Ze(a,t,e,o,i,r){const s=a.context,n=e.rect(t.panel),l=t.place==="top"||t.place==="bottom",c=l?n.width:n.height,u=l?n.height:n.width,h=i.info,f=xe(r,h.lo,h.hi)||1,d=Math.max(2,Math.round(.4*o));for(let M=0;M<n.height;M+=d)for(let E=0;E<n.width;E+=d){const k=(E/d+M/d)%2?219:255;I(s,[k,k,k,255],n.x+E,n.y+M,Math.min(d,n.width-E),Math.min(d,n.height-M))}let m=-1;const v=Math.max(1,Math.round(.08*o));for(let M=0;M<c;++M){const E=i.value(l?M/Math.max(1,c-1):1-M/Math.max(1,c-1)),k=et(r,E),S=Math.min(u-1,Math.max(0,Math.round(k/f*(u-1)))),K=[...Array.from(i.color(E)).slice(0,3).map(po=>Math.round(255*St(po))),255],G=Math.max(0,Math.min(S,m<0?S:m)-v+1),At=Math.max(S,m);l?(I(s,K,n.x+M,n.y+u-S,1,S),I(s,[26,26,31,255],n.x+M,n.y+u-1-At,1,At-G+1)):(I(s,K,n.x,n.y+M,S,1),I(s,[26,26,31,255],n.x+G,n.y+M,At-G+1,1)),m=S}a.frame(n.x,n.y,n.width,n.height);const[g,,p]=t.panel_texts,x=.78*o,w=a.measure("0",{size:x}).height,y=String(Number(f.toPrecision(2)));if(l){const M=n.x+n.width+.5*o;a.text(y,M,n.y-.15*w,{size:x,halo:!0}),a.text(g,M,n.y+n.height-.85*w,{size:x,halo:!0}),a.text(p,M,n.y+.5*(n.height-w),{size:x,halo:!0});return}const b=n.y+n.height+.25*o;a.text(g,n.x,b,{size:x,halo:!0}),a.text(y,n.x+n.width-a.measure(y,{size:x}).width,b,{size:x,halo:!0});const A=Math.min(n.width,a.measure(p,{size:x}).width);a.text(p,n.x+.5*(n.width-A),b+.95*w,{size:x,halo:!0})}function to(a,t,e,o){const i=e.rect(t.glyph),r=i.y+.5*i.height,s=X(t.glyph_color),n=e.length(t.glyph[2]);if(t.glyph_arrow){const l=Math.min(.9*o,.4*n),c=.4*l,u=Math.max(.5,.12*l),h=i.x+n-l;a.polygon([[i.x,r-u],[h,r-u],[h,r-c],[i.x+n,r],[h,r+c],[h,r+u],[i.x,r+u]],s,!0)}else{const l=.5*Math.min(n,i.height);a.polygon(Array.from({length:32},(c,u)=>[i.x+l+l*Math.cos(u*.19634954),r+l*Math.sin(u*.19634954)]),s,!0)}a.text("= "+(t.glyph_text??""),i.x+n+.6*o,r-.58*o,{size:o,halo:!0})}const eo='"DejaVu Sans", Verdana, "Bitstream Vera Sans", "Helvetica Neue", Arial, sans-serif',oo=.928,Vt=1.164;class ao{constructor(t,e){this.context=t,this.ink=e?"rgb(237 237 242)":"rgb(23 23 28)",this.rim=e?"rgb(13 13 18)":"rgb(255 255 255)"}lines(t,e){const o=this.context;o.font=`${e.bold?"bold ":""}${e.size}px ${eo}`;const i=t.replaceAll("⁠","");if(!e.wrap||o.measureText(i.replaceAll("​","")).width<=e.wrap*1.002)return[i.replaceAll("​","")];if(e.cut){let n=i.length;for(;n>1&&o.measureText(i.slice(0,n)+"…").width>e.wrap;)--n;return[i.slice(0,n)+"…"]}const r=[];let s="";for(const n of i.split(/(?<=[ \u200b])/))s&&o.measureText((s+n).trimEnd().replaceAll("​","")).width>e.wrap*1.002&&(r.push(s),s=""),s+=n;return[...r,s].map(n=>n.replaceAll("​","").trimEnd())}measure(t,e){const o=this.lines(t,e);return{width:Math.max(...o.map(i=>this.context.measureText(i).width)),height:o.length*Vt*e.size,lines:o.length}}text(t,e,o,i){const r=this.context,s=this.lines(t,i),n=Math.max(...s.map(l=>r.measureText(l).width));r.textBaseline="alphabetic",r.textAlign="left",r.lineJoin="round",s.forEach((l,c)=>{const u=e+(i.centred?.5*(n-r.measureText(l).width):0),h=o+(c*Vt+oo)*i.size;i.halo&&(r.strokeStyle=this.rim,r.lineWidth=.2*i.size,r.strokeText(l,u,h)),r.fillStyle=i.color??this.ink,r.fillText(l,u,h)})}turned(t,e,o,i,r){const s=this.context,n=this.measure(t,r);s.save(),s.translate(e,o),s.rotate(-i),this.text(t,-.5*n.width,-.5*n.height,r),s.restore()}line(t,e,o,i,r,s=this.ink,n=1){const l=this.context;l.globalAlpha=n,l.strokeStyle=s,l.lineWidth=r,l.lineCap="butt",l.beginPath(),l.moveTo(t,e),l.lineTo(o,i),l.stroke(),l.globalAlpha=1}polygon(t,e,o=!1){const i=this.context;i.beginPath(),t.forEach(([r,s],n)=>n?i.lineTo(r,s):i.moveTo(r,s)),i.closePath(),i.fillStyle=e,i.fill(),o&&(i.globalAlpha=.35,i.strokeStyle=this.ink,i.lineWidth=1,i.stroke(),i.globalAlpha=1)}frame(t,e,o,i){const r=this.context;r.globalAlpha=.35,r.strokeStyle=this.ink,r.lineWidth=1,r.strokeRect(t-.5,e-.5,o+1,i+1),r.globalAlpha=1}}function io(a,t){const{annotation:e,layout:o,projection:i}=t,r=new ao(a,e.dark),s=e.font*o.factor,{area:n}=o,l=[];if(e.title){const u=e.title_size*o.factor,h=Math.max(1,o.width-1.6*s),f=r.measure(e.title,{size:u,wrap:h}),d={x:.5*(o.width-f.width),y:e.title_box[1]*o.factor,width:f.width,height:f.height};r.text(e.title,d.x,d.y,{size:u,wrap:h,centred:!0,halo:!0}),l.push(d)}for(const u of e.legends)l.push(j(Ke(r,u,e,o,t.scales,t.opacity),.5*s));for(const u of l)u.x-=n.x,u.y-=n.y;a.save(),a.translate(n.x,n.y);const c=e.triad&&t.axes;if(e.letters&&co(r,i,s,l),c&&l.push(Bt(i.height,s)),e.caption){const u={size:s,wrap:Math.max(1,.55*i.width),centred:!0,halo:!0},h=r.measure(e.caption,u),f=e.caption_height>0,d={x:.5*(i.width-h.width),y:(f?o.height-n.y:i.height)-.6*s-h.height,width:h.width,height:h.height};r.text(e.caption,d.x,d.y,u),l.push(j(d,.3*s))}e.scale_bar&&t.box&&no(r,e,i,t.box,s,l),ro(r,e,i,o,s,l),t.axes&&(so(r,e,i,.88*s,l),t.box&&Ge(r,e,t.box,i,s,l)),c&&We(r,e,i,s),a.restore()}function so(a,t,e,o,i){for(const r of t.texts){const s=Y(e,r.at);if(!e.parallel&&!(s[2]>0))continue;const n=[_(r.along,e.right),_(r.along,e.up),_(r.along,e.forward)],l=(s[0]-.5*e.width)/e.scale,c=(.5*e.height-s[1])/e.scale,u=e.parallel?n[0]:n[0]-n[2]*l,h=e.parallel?n[1]:n[1]-n[2]*c;let f=u*u+h*h<1e-6*_(r.along,r.along)||!(_(r.along,r.along)>0)?0:Math.atan2(h,u);f>Math.PI/2+1e-9?f-=Math.PI:f<=-Math.PI/2+1e-9&&(f+=Math.PI);const d=o*r.size,m=a.measure(r.text,{size:d}),v=Math.max(1,Math.ceil(m.width/m.height)),g=[];for(let p=0;p<v;++p){const x=v>1?(p/(v-1)-.5)*(m.width-m.height):0;g.push({x:s[0]+x*Math.cos(f)-.5*m.height,y:s[1]-x*Math.sin(f)-.5*m.height,width:m.height,height:m.height})}g.some(p=>p.x<1||p.y<1||p.x+p.width>e.width-1||p.y+p.height>e.height-1||i.some(x=>$(x,p)))||(a.turned(r.text,s[0],s[1],f,{size:d,halo:!0,color:r.color?Ft(r.color):void 0}),i.push(...g))}}function ro(a,t,e,o,i,r){for(const s of t.notes){const n=i*s.size,l={size:n,wrap:Math.max(1,.9*o.width),halo:!0,color:s.color?Ft(s.color):void 0},c=a.measure(s.text,l),u=.6*i;let h=.5*(e.width-c.width),f=.5*(e.height-c.height);if(s.at)h=s.at[0]*o.width-o.area.x-.5*c.width,f=s.at[1]*o.height-o.area.y-.5*c.height;else{s.place.includes("left")&&(h=u),s.place.includes("right")&&(h=e.width-c.width-u),s.place.includes("top")&&(f=u),s.place.includes("bottom")&&(f=e.height-c.height-u);const d=s.place.includes("bottom")?-.5*i:.5*i;for(let m=0;m<100&&r.some(v=>$(v,{x:h,y:f,width:c.width,height:c.height}));++m)f+=d}a.text(s.text,h,f,l),r.push({x:h,y:f,width:c.width,height:c.height})}}function no(a,t,e,o,i,r){const s=Y(e,[0,1,2].map(y=>.5*(o.lo[y]+o.hi[y]))),n=e.parallel?e.scale:e.scale/s[2];if(!(s[2]>0||e.parallel)||!(n>0))return;const l=.22*e.width/n,c=10**Math.floor(Math.log10(l)),u=(l/c>=5?5:l/c>=2?2:1)*c,h=u*n,f=`${Number(u.toPrecision(6))}${t.unit?" "+t.unit:""}`,d=a.measure(f,{size:i}),m=Math.max(2,.22*i),v=Math.max(d.width,h),g=d.height+.35*i+m,p={x:e.width-.9*i-v,y:e.height-.9*i-g,width:v,height:g},x=p.x+.5*(v-h),w=p.y+p.height-.5*m;a.line(x,w,x+h,w,m),a.text(f,p.x+.5*(v-d.width),p.y,{size:i,halo:!0}),r.push(j(p,.3*i))}function lo(a){const t=[["R","L"],["A","P"],["I","S"]];return[0,1,2].filter(e=>Math.abs(a[e])>=.375).sort((e,o)=>Math.abs(a[o])-Math.abs(a[e])).map(e=>t[e][a[e]>0?1:0]).join("")}function co(a,t,e,o){const i=1.25*e,r=.6*e,s=n=>[-n[0],-n[1],-n[2]];for(const[n,l,c]of[[s(t.right),0,.5],[t.right,1,.5],[t.up,.5,0],[s(t.up),.5,1]]){const u=lo(n),h=a.measure(u,{size:i,bold:!0}),f={x:r+l*(t.width-h.width-2*r),y:r+c*(t.height-h.height-2*r),width:h.width,height:h.height};o.some(d=>$(d,f))||(a.text(u,f.x,f.y,{size:i,bold:!0,halo:!0}),o.push(j(f,.5*e)))}}const ho=15,uo=180,fo=40;class Tt{constructor(t,e,o,i,r){this.gl=t,this.canvas=e,this.over=o,this.scene=i,this.store=r,this.axes=!0,this.number=0,this.scales=[],this.frameTimes=[],this.onStep=null,this.onStill=null,this.behind=null,this.coarse=0,this.level=1,this.lastLevel=0,this.asked=0,this.rest=0,this.generation=0,this.ratio=1,this.moving=!1,this.still=!1,this.camera=new rt(i.camera),this.first=new rt(i.camera),this.composer=new re(t,i),this.context=o.getContext("2d",{willReadFrequently:!0});const s=i.steps[0];this.center=_t(It(s.items,s.annotation)),this.steps=i.steps.map(()=>{})}static async open(t,e,o,i,r){const s=new oe(i.arrays,r),n=new Tt(t,e,o,i,s);return n.scales=await ue(t,i.scales,s),await n.show(0),n}async show(t){const e=this.step?.volumes[0]?.points;this.number=t,this.steps[t]??=Ve(this.gl,this.scene,t,this.center,this.scales,this.store);const o=await this.steps[t];this.number===t&&(this.step=o,e&&o.volumes[0]&&o.volumes[0].points!==e&&o.volumes[0].setOpacity(e),this.behind=o.annotation.box_behind&&o.box?new $e(this.gl,o.box,this.center):null,await this.behind?.load(this.store),this.resize(),this.onStep?.())}resize(){const t=Math.max(1,this.canvas.clientWidth),e=Math.max(1,this.canvas.clientHeight);this.ratio=Math.min(2,window.devicePixelRatio||1);const o=Math.round(t*this.ratio),i=Math.round(e*this.ratio);(this.over.width!==o||this.over.height!==i)&&(this.over.width=o,this.over.height=i),this.layout=He(this.step.annotation,t,e),this.draw(this.step.volumes.length>0)}aspect(){return this.layout.area.width/this.layout.area.height}stated(){const[,,t,e]=this.step.annotation.area;return t/e}projection(t=1){const{area:e}=this.layout,o=Math.max(1,Math.round(e.width*t)),i=Math.max(1,Math.round(e.height*t));return this.camera.projection(o,i,Math.min(this.stated(),1.2),this.step.bounds)}draw(t){++this.generation,this.still=!1,this.moving=t||this.moving&&this.asked!==0,clearTimeout(this.rest),this.asked||(this.asked=requestAnimationFrame(()=>{this.asked=0,this.moving?(this.drawMoving(),this.rest=window.setTimeout(()=>{this.moving=!1,this.drawStill()},uo)):this.drawStill()}))}area(t){const{area:e,height:o}=this.layout;return{x:Math.round(e.x*t),y:Math.round((o-e.y-e.height)*t),width:Math.round(e.width*t),height:Math.round(e.height*t)}}pass(t,e){const o=this.projection(t*this.ratio),i={projection:o,center:this.center,samples:t*this.ratio,lamps:le(this.scene,o),peel:null,moving:e,soft:t===1&&!e},r=this.axes?this.behind?.at(o):null;return{pass:i,drawables:r?[...this.step.drawables,r]:this.step.drawables}}present(t){const e=this.ratio*Math.min(1,t),o=Math.max(1,Math.round(this.layout.width*e)),i=Math.max(1,Math.round(this.layout.height*e));(this.canvas.width!==o||this.canvas.height!==i)&&(this.canvas.width=o,this.canvas.height=i),this.composer.present(o,i,this.area(e),Math.max(1,t));const r=this.context;r.setTransform(this.ratio,0,0,this.ratio,0,0),r.clearRect(0,0,this.layout.width,this.layout.height),io(r,{annotation:this.step.annotation,layout:this.layout,projection:this.projection(),box:this.step.box,scales:this.scales,opacity:this.step.volumes[0]?.points??null,axes:this.axes})}drawMoving(){this.coarse===0&&(this.coarse=this.level=this.step.volumes.length?2**-2.5:1),(this.coarse>1.5*this.level||this.coarse<.9*this.level)&&(this.level=2**(Math.floor(2*Math.log2(this.coarse))/2));const t=performance.now(),e=this.level,o=e===this.lastLevel,{pass:i,drawables:r}=this.pass(e,!0);this.composer.finish();const s=performance.now();this.composer.draw(i,r,this.step.volumes,{samples:e,coarse:2,layers:3}),this.composer.finish();const n=performance.now()-s;if(this.present(e),this.frameTimes.push(performance.now()-t),this.frameTimes.length>120&&this.frameTimes.shift(),this.lastLevel=e,!o)return;const l=this.level*Math.min(2,Math.max(.25,Math.sqrt(ho/n)));this.coarse=Math.min(1,Math.max(2**-3.5,this.coarse+.3*(l-this.coarse)))}stillQuality(){return{samples:this.step.drawables.some(e=>e.stage==="surface")?2:this.step.volumes.length?1:3,coarse:1,layers:8}}drawStill(){const t=this.stillQuality();this.step.volumes.length&&this.level<.5?this.drawFine({...t,samples:.5},()=>this.drawFine(t,()=>this.rested())):this.drawFine(t,()=>this.rested())}rested(){this.still=!0,this.onStill?.()}drawFine(t,e){const o=this.generation,{pass:i,drawables:r}=this.pass(t.samples,!1),s=i.projection.height,n=this.step.volumes.length>0;let l=0,c=n?Math.max(4,Math.round(s/40)):s;const u=()=>{if(o!==this.generation)return;const h=performance.now(),f=Math.min(s,l+c);if(this.composer.draw(i,r,this.step.volumes,t,[l,f]),l=f,l<s){this.composer.finish(),c=Math.max(2,Math.round(c*Math.min(2,Math.max(.5,fo/(performance.now()-h))))),requestAnimationFrame(u);return}this.present(t.samples),e()};u()}setOpacity(t){for(const e of this.step.volumes)e.setOpacity(t);this.draw(!0)}snapshot(){const t=document.createElement("canvas"),e=t.getContext("2d");t.width=this.canvas.width,t.height=this.canvas.height;const o=this.stillQuality(),{pass:i,drawables:r}=this.pass(o.samples,!1);return this.still||this.composer.draw(i,r,this.step.volumes,o),this.present(o.samples),e.drawImage(this.canvas,0,0),e.drawImage(this.over,0,0),t}}const Et=a=>document.getElementById(a)?.textContent??"";function ft(a){document.querySelector(".stage")?.remove(),document.body.append(T("p",{className:"sentence",textContent:a,role:"status"})),document.documentElement.dataset.state="picture"}async function mo(){document.head.append(T("style",{textContent:$t}));const a=T("canvas",{}),t=T("canvas",{}),e=a.getContext("webgl2",{antialias:!1,alpha:!1,powerPreference:"high-performance"});if(!e)return ft("This browser has no WebGL2, or it is switched off: the picture does not turn here.");if(typeof DecompressionStream>"u")return ft("This browser is too old to unpack the scene: the picture does not turn here.");const o=JSON.parse(Et("scene")),i=T("div",{className:"stage",tabIndex:0,role:"application",ariaLabel:document.title},a,t);document.body.append(i),document.body.classList.toggle("timed",o.steps.length>1);const r=await Tt.open(e,a,t,o,c=>Et(`a${c}`));a.addEventListener("webglcontextlost",()=>ft("The graphics card has given up this page: load it again."));const s=[];let n=null;if(r.step.volumes.length&&r.step.volumes[0].info.mode!=="sum"){n=new qt(r);const c=n;s.push(N("opacity","The opacity of the volume (o)",()=>{c.panel.hidden=!c.panel.hidden}))}s.push(Jt(o.notes,JSON.parse(Et("recipe")||'""')));const l=Kt(r,document.title,s);if(document.body.append(l.bar),n){const c=n;document.body.append(c.panel),l.keys.o=()=>{c.panel.hidden=!c.panel.hidden},r.onStep=()=>c.paint()}if(o.steps.length>1){const c=Yt(r);document.body.append(c.bar),l.keys[" "]=c.play;const u=r.onStep;r.onStep=()=>{u?.(),c.tell()}}Ht(r,i,l.keys),new ResizeObserver(()=>r.resize()).observe(i),r.onStill=()=>{document.getElementById("poster")?.remove(),document.documentElement.dataset.state="still"},Object.assign(window,{sightglass:{viewer:r,editor:n}})}mo().catch(a=>ft(`The scene cannot be shown: ${a instanceof Error?a.message:String(a)}.`))})();
