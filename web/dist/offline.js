(function(){"use strict";const Wt="html,body{margin:0;height:100%;overflow:hidden;background:#fff;font:13px DejaVu Sans,Verdana,Arial,sans-serif;color:#17171c}#poster{position:absolute;inset:0;margin:auto;max-width:100%;max-height:100%;width:100%;height:100%;object-fit:contain}.sentence{position:absolute;left:0;right:0;bottom:0;margin:0;padding:.6em 1em;background:#fffbe6;text-align:center}.stage{position:absolute;inset:0;touch-action:none;outline:none}.stage>canvas{position:absolute;inset:0;width:100%;height:100%;display:block}.stage>canvas+canvas{pointer-events:none}.bar{position:absolute;left:6px;top:6px;display:flex;flex-wrap:wrap;gap:2px;opacity:.7;transition:opacity .2s;max-width:calc(100% - 12px);align-items:flex-start}.bar:hover,.bar:focus-within,.bar:has([open]),.times,.editor{opacity:1}.timed .stage{bottom:36px}.times{inset:auto 0 0;height:36px;max-width:none;justify-content:center;align-items:center;gap:8px;background:#f4f4f6}.times input{width:240px;max-width:40vw}button,select,summary{font:inherit;font-size:12px;color:inherit;background:#ffffffd8;border:1px solid #0003;border-radius:4px;padding:2px 7px;cursor:pointer}button:hover,summary:hover{background:#e8f0ff}.editor{position:absolute;left:8px;bottom:8px;padding:8px;background:#fffffff0;border:1px solid #0003;border-radius:6px;width:360px}.editor[hidden]{display:none}.editor canvas{display:block;cursor:crosshair;touch-action:none;background:#fafafa}.editor .row{display:flex;gap:6px;margin-top:6px;align-items:center}.editor .words{flex:1;min-width:0;font:11px monospace}.about{position:relative}.about[open]{background:#fffffff0;border:1px solid #0003;border-radius:6px;padding:0 10px 8px 0;max-width:440px;max-height:70vh;overflow:auto}.about summary{list-style:none;display:inline-block}.about p,.about ul,.about pre{margin:6px 0 0 10px}.about pre{font-size:11px;white-space:pre-wrap}@media(prefers-reduced-motion:reduce){.bar{transition:none}}";function Yt(i,t,e){const o=new Map,a=()=>i.layout.area.height;t.addEventListener("contextmenu",s=>s.preventDefault()),t.addEventListener("pointerdown",s=>{t.setPointerCapture(s.pointerId),t.focus(),o.set(s.pointerId,{x:s.clientX,y:s.clientY})});const r=s=>o.delete(s.pointerId);t.addEventListener("pointerup",r),t.addEventListener("pointercancel",r),t.addEventListener("pointermove",s=>{const n=o.get(s.pointerId);if(!n)return;const c=s.clientX-n.x,l=s.clientY-n.y;if(o.size===1)s.buttons&6||s.shiftKey?i.camera.pan(c/a(),l/a()):s.ctrlKey||s.metaKey?i.camera.roll(c/a()*Math.PI):i.camera.turn(c/a()*Math.PI,l/a()*Math.PI);else if(o.size===2){const u=[...o].find(([d])=>d!==s.pointerId)[1],h=Math.hypot(n.x-u.x,n.y-u.y),f=Math.hypot(s.clientX-u.x,s.clientY-u.y);h>0&&f>0&&i.camera.zoom(f/h),i.camera.pan(.5*c/a(),.5*l/a())}o.set(s.pointerId,{x:s.clientX,y:s.clientY}),i.draw(!0)}),t.addEventListener("wheel",s=>{s.preventDefault(),i.camera.zoom(Math.exp(-s.deltaY*(s.deltaMode===1?.05:.0015))),i.draw(!0)},{passive:!1}),t.addEventListener("keydown",s=>{const c={ArrowLeft:[-1,0],ArrowRight:[1,0],ArrowUp:[0,-1],ArrowDown:[0,1]}[s.key];if(c&&s.shiftKey)i.camera.pan(.05*c[0],.05*c[1]);else if(c)i.camera.turn(.1*c[0],.1*c[1]);else if(s.key==="+"||s.key==="=")i.camera.zoom(1.1);else if(s.key==="-")i.camera.zoom(1/1.1);else if(e[s.key]&&!s.ctrlKey&&!s.metaKey&&!s.altKey)e[s.key]();else return;s.preventDefault(),i.draw(!0)})}function T(i,t={},...e){const o=Object.assign(document.createElement(i),t);return o.append(...e),o}const N=(i,t,e)=>T("button",{type:"button",textContent:i,title:t,onclick:e,ariaLabel:t}),Kt=i=>i<=.04045?i/12.92:((i+.055)/1.055)**2.4,Ft=i=>i<=.0031308?12.92*i:1.055*i**(1/2.4)-.055,q=i=>`rgb(${i[0]} ${i[1]} ${i[2]})`,Ct=i=>q([0,1,2].map(t=>Math.round(255*i[t]))),R=360,D=150,Jt=9;function Qt(i){const t=e=>String(Number(e.toPrecision(5)));return`volume opacity=${i.map(([e,o])=>`@${t(e)}:${t(o)}`).join(",")}`}class Zt{constructor(t){this.v=t,this.canvas=T("canvas",{tabIndex:0,ariaLabel:"Opacity over values"}),this.words=T("input",{readOnly:!0,className:"words",ariaLabel:"The same on the command line"}),this.logarithmic=!0,this.held=-1;const e=t.step.volumes[0].info;this.points=e.opacity.map(([c,l])=>[c,l]),this.most=Math.max(.02,...this.points.map(([,c])=>c));const o=Math.min(2,window.devicePixelRatio||1);this.canvas.width=R*o,this.canvas.height=D*o,this.canvas.style.width=`${R}px`,this.canvas.style.height=`${D}px`,this.canvas.getContext("2d").scale(o,o);const a=T("input",{type:"checkbox",checked:!0});a.onchange=()=>{this.logarithmic=a.checked,this.paint()};const r=T("select",{ariaLabel:"Largest opacity shown",title:"Largest opacity shown"},...["0.02","0.05","0.1","0.2","0.5","1"].map(c=>T("option",{value:c,textContent:`to ${c}`})));this.most=[.02,.05,.1,.2,.5,1].find(c=>c>=this.most*.999)??1,r.value=String(this.most),r.onchange=()=>{this.most=Number(r.value),this.paint()};const s=N("reset","The opacity of the picture",()=>{this.points=e.opacity.map(([c,l])=>[c,l]),this.changed()}),n=N("copy","Copy the words for the command line",()=>{this.words.select(),document.execCommand("copy")});this.panel=T("div",{className:"editor",hidden:!0},this.canvas,T("div",{className:"row"},T("label",{},a," log counts"),r,s),T("div",{className:"row"},this.words,n)),this.canvas.onpointerdown=c=>this.press(c),this.canvas.onpointermove=c=>this.drag(c),this.canvas.onpointerup=this.canvas.onpointercancel=()=>{this.held=-1},this.canvas.ondblclick=c=>{const l=this.nearest(c);l>=0&&this.points.length>1&&(this.points.splice(l,1),this.changed())},this.paint()}x(t){const[e,o]=this.v.step.volumes[0].info.told;return(t-e)/(o-e||1)*(R-1)}value(t){const[e,o]=this.v.step.volumes[0].info.told;return e+Math.min(R-1,Math.max(0,t))/(R-1)*(o-e)}y(t){return(D-1)*(1-t/this.most)}at(t){const e=this.canvas.getBoundingClientRect();return[t.clientX-e.left,t.clientY-e.top]}nearest(t){const[e,o]=this.at(t);let a=-1,r=Jt;return this.points.forEach(([s,n],c)=>{const l=Math.hypot(this.x(s)-e,Math.min(D-1,Math.max(0,this.y(n)))-o);l<r&&(r=l,a=c)}),a}press(t){if(this.canvas.setPointerCapture(t.pointerId),this.held=this.nearest(t),this.held>=0)return;const[e,o]=this.at(t),a=[this.value(e),this.opacity(o)];this.held=this.points.findIndex(([r])=>r>a[0]),this.held<0&&(this.held=this.points.length),this.points.splice(this.held,0,a),this.changed()}opacity(t){return Math.min(1,Math.max(0,(1-t/(D-1))*this.most))}drag(t){if(this.held<0||!t.buttons)return;const[e,o]=this.at(t),a=this.points[this.held-1]?.[0]??-1/0,r=this.points[this.held+1]?.[0]??1/0;this.points[this.held]=[Math.min(r,Math.max(a,this.value(e))),this.opacity(o)],this.changed()}changed(){this.v.setOpacity(this.points.map(([t,e])=>[t,e])),this.paint()}paint(){const t=this.canvas.getContext("2d"),e=this.v.step.volumes[0],{histogram:o,told:a}=e.info,r=o.length;t.clearRect(0,0,R,D);const s=c=>this.logarithmic?Math.log1p(c):c,n=Math.max(1e-9,...o.map(s));for(let c=0;c<r;++c){const l=Array.from(e.scale.color(a[0]+(c+.5)/r*(a[1]-a[0]))).slice(0,3).map(h=>Math.round(255*Ft(h))),u=s(o[c])/n*(D-4);t.fillStyle=q(l),t.fillRect(c*R/r,D-u,R/r+.5,u)}t.strokeStyle="#111",t.lineWidth=1.5,t.beginPath(),t.moveTo(0,this.y(this.points[0]?.[1]??0));for(const[c,l]of this.points)t.lineTo(this.x(c),this.y(l));t.lineTo(R,this.y(this.points.at(-1)?.[1]??0)),t.stroke();for(const[c,l]of this.points)t.beginPath(),t.arc(this.x(c),Math.min(D-1,Math.max(0,this.y(l))),4.5,0,2*Math.PI),t.fillStyle="#fff",t.fill(),t.stroke();this.words.value=`--show '${Qt(this.points)}'`}}const te=8;function ee(i){const t=i.scene.steps.length,e=T("input",{type:"range",min:"0",max:String(t-1),step:"1",value:"0",ariaLabel:"Time step"}),o=T("span",{className:"time"});let a=0;const r=()=>{const l=i.scene.steps[i.number].time;o.textContent=`${i.number+1} of ${t}${l===void 0?"":`, t = ${Number(l.toPrecision(6))}`}`,e.value=String(i.number)},s=async()=>{const l=performance.now();await i.show((i.number+1)%t),a&&(a=window.setTimeout(s,Math.max(0,1e3/te-(performance.now()-l))))},n=()=>{a?(clearTimeout(a),a=0):a=window.setTimeout(s,0),c.textContent=a?"❚❚":"►"},c=N("►","Play (space)",n);return e.oninput=()=>void i.show(Number(e.value)),r(),{bar:T("div",{className:"bar times"},c,e,o),play:n,tell:r}}function oe(i,t,e){const o=T("div",{className:"bar",role:"toolbar",ariaLabel:"Camera"}),a={},r=u=>()=>{const h=i.scene.views[u];i.camera.fit(i.step.box??i.step.bounds,h.direction,h.up,i.aspect(),i.scene.margin),i.draw(!1)};Object.keys(i.scene.views).forEach((u,h)=>{o.append(N(u,`View: ${u} (${h+1})`,r(u))),a[String(h+1)]=r(u)});const s=()=>{i.camera.set(i.first.copy()),i.draw(!1)},n=()=>{i.camera.setParallel(!i.camera.parallel),l.textContent=i.camera.parallel?"parallel":"perspective",i.draw(!1)},c=()=>{i.axes=!i.axes,i.draw(!1)},l=N(i.camera.parallel?"parallel":"perspective","Perspective or parallel projection (p)",n);return a.r=s,a.p=n,a.a=c,o.append(N("reset","The view of the picture (r)",s),l),i.step.annotation.axes&&o.append(N("axes","Box, numbers and orientation (a)",c)),o.append(N("save","Save what is seen as PNG",()=>{i.snapshot().toBlob(u=>{if(!u)return;const h=T("a",{href:URL.createObjectURL(u),download:`${t||"picture"}.png`});h.click(),setTimeout(()=>URL.revokeObjectURL(h.href),1e4)})})),o.append(...e),{bar:o,keys:a}}function ae(i,t){const e=T("ul",{},...i.map(r=>T("li",{textContent:r}))),a=T("details",{className:"about"},T("summary",{textContent:"about",title:"What is in this page"}),T("p",{textContent:"Drag turns, with shift or the right button it shifts, with ctrl it rolls; the wheel zooms; arrows, + and − too."}));return i.length&&a.append(T("p",{textContent:"To keep within its size, or for speed:"}),e),t&&a.append(T("p",{textContent:"The picture's pipeline:"}),T("pre",{textContent:t})),a}function ie(i){const t=Uint8Array;if(t.fromBase64)return t.fromBase64(i);const e=atob(i),o=new Uint8Array(e.length);for(let a=0;a<e.length;++a)o[a]=e.charCodeAt(a);return o}async function se(i){const t=new Blob([i]).stream().pipeThrough(new DecompressionStream("deflate-raw"));return new Uint8Array(await new Response(t).arrayBuffer())}function re(i){switch(i.type){case"u8":return new Uint8Array(i.count);case"u16":return new Uint16Array(i.count);case"u32":return new Uint32Array(i.count);default:return new Float32Array(i.count)}}function ne(i,t){const e=re(i),o=e.BYTES_PER_ELEMENT,a=i.count,r=i.stride;if(t.length!==a*o)throw new Error(`an array has ${t.length} bytes, not ${a*o}: the file is damaged`);if(i.coding==="plain")new Uint8Array(e.buffer).set(t);else if(i.coding==="planes"){const s=new Uint8Array(e.buffer);for(let n=0;n<o;++n)for(let c=0,l=n*a;c<a;++c)s[c*o+n]=t[l+c]}else for(let s=0;s<a;++s){let n=t[s];o>1&&(n|=t[a+s]<<8),o>2&&(n|=t[2*a+s]<<16|t[3*a+s]<<24);const c=n>>>1^-(n&1);e[s]=s>=r?c+e[s-r]:c}return e}class le{constructor(t,e){this.infos=t,this.text=e,this.kept=new Map}get(t){let e=this.kept.get(t);return e||(e=se(ie(this.text(t))).then(o=>ne(this.infos[t],o)),this.kept.set(t,e)),e}}class O{constructor(t,e,o){this.gl=t,this.places=new Map;const a=t.createProgram();for(const[r,s]of[[t.VERTEX_SHADER,e],[t.FRAGMENT_SHADER,o]]){const n=t.createShader(r);if(t.shaderSource(n,`#version 300 es
precision highp float;
precision highp int;
precision highp sampler3D;
`+s),t.compileShader(n),!t.getShaderParameter(n,t.COMPILE_STATUS))throw new Error(t.getShaderInfoLog(n)??"a shader cannot be compiled");t.attachShader(a,n)}if(t.linkProgram(a),!t.getProgramParameter(a,t.LINK_STATUS))throw new Error(t.getProgramInfoLog(a)??"a program cannot be linked");this.handle=a}use(){this.gl.useProgram(this.handle)}place(t){return this.places.has(t)||this.places.set(t,this.gl.getUniformLocation(this.handle,t)),this.places.get(t)}f(t,...e){const o=this.gl,a=this.place(t);e.length===1?o.uniform1f(a,e[0]):e.length===2?o.uniform2f(a,e[0],e[1]):e.length===3?o.uniform3f(a,e[0],e[1],e[2]):o.uniform4f(a,e[0],e[1],e[2],e[3])}i(t,e){this.gl.uniform1i(this.place(t),e)}texture(t,e,o,a=this.gl.TEXTURE_2D){this.gl.activeTexture(this.gl.TEXTURE0+e),this.gl.bindTexture(a,o),this.i(t,e)}}function F(i,t,e,o,a=0,r=i.FLOAT,s=!1,n=0,c=0){const l=i.createBuffer();return i.bindBuffer(i.ARRAY_BUFFER,l),i.bufferData(i.ARRAY_BUFFER,e,i.STATIC_DRAW),ce(i,t,l,o,a,r,s,n,c),l}function ce(i,t,e,o,a,r,s,n,c){i.bindBuffer(i.ARRAY_BUFFER,e),i.enableVertexAttribArray(t),i.vertexAttribPointer(t,o,r,s,n,c),i.vertexAttribDivisor(t,a)}class H{constructor(t,e,o){this.gl=t,this.format=e,this.withDepth=o,this.width=0,this.height=0,this.color=null,this.depth=null,this.frame=t.createFramebuffer()}resize(t,e){if(t===this.width&&e===this.height)return;const o=this.gl;this.width=t,this.height=e,o.deleteTexture(this.color),o.deleteTexture(this.depth),o.bindFramebuffer(o.FRAMEBUFFER,this.frame),this.color=mt(o,this.format,t,e,o.LINEAR),o.framebufferTexture2D(o.FRAMEBUFFER,o.COLOR_ATTACHMENT0,o.TEXTURE_2D,this.color,0),this.withDepth&&(this.depth=mt(o,o.DEPTH24_STENCIL8,t,e,o.NEAREST),o.framebufferTexture2D(o.FRAMEBUFFER,o.DEPTH_STENCIL_ATTACHMENT,o.TEXTURE_2D,this.depth,0))}bind(){this.gl.bindFramebuffer(this.gl.FRAMEBUFFER,this.frame),this.gl.viewport(0,0,this.width,this.height)}}function mt(i,t,e,o,a){const r=i.createTexture();i.activeTexture(i.TEXTURE0),i.bindTexture(i.TEXTURE_2D,r),i.texStorage2D(i.TEXTURE_2D,1,t,e,o);for(const[s,n]of[[i.TEXTURE_MIN_FILTER,a],[i.TEXTURE_MAG_FILTER,a],[i.TEXTURE_WRAP_S,i.CLAMP_TO_EDGE],[i.TEXTURE_WRAP_T,i.CLAMP_TO_EDGE]])i.texParameteri(i.TEXTURE_2D,s,n);return r}function pt(i,t){const e=t.length/4,o=Math.max(1,Math.ceil(e/1024)),a=new Float32Array(o*4096);a.set(t);const r=mt(i,i.RGBA32F,1024,o,i.NEAREST);return i.texSubImage2D(i.TEXTURE_2D,0,0,0,1024,o,i.RGBA,i.FLOAT,a),r}const gt=`
void main() {
  gl_Position = vec4((gl_VertexID & 1) == 1 ? 3.0 : -1.0, (gl_VertexID & 2) == 2 ? 3.0 : -1.0, 0.0, 1.0);
}`,he=`
uniform sampler2D uFrom;
out vec4 oColor;
void main() { oColor = texelFetch(uFrom, ivec2(gl_FragCoord.xy), 0); }`,ue=`
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
}`;class fe{constructor(t,e){this.gl=t,this.scene=e,this.counted=null,this.limit=null,this.limiter=null,this.zero=null;const o=t.getExtension("EXT_color_buffer_float")||t.getExtension("EXT_color_buffer_half_float"),a=this.format=o?t.RGBA16F:t.SRGB8_ALPHA8;this.copy=new O(t,gt,he),this.resolve=new O(t,gt,ue),this.opaque=new H(t,a,!0),this.sum=new H(t,a,!1),this.layers=[new H(t,a,!0),new H(t,a,!0)]}layersOf(t,e,o){const a=this.gl,r=e.filter(p=>p.translucent),s=t.projection;if(!r.length||this.format!==a.RGBA16F)return r.length?o:0;const n=Math.min(1,240/s.width),c=Math.max(1,Math.round(s.width*n)),l=Math.max(1,Math.round(s.height*n)),u=this.counted??=new H(a,a.RGBA16F,!1);u.resize(c,l),u.bind(),a.disable(a.SCISSOR_TEST),a.disable(a.DEPTH_TEST),a.clearColor(0,0,0,0),a.clear(a.COLOR_BUFFER_BIT),a.enable(a.BLEND),a.blendFunc(a.ONE,a.ONE);const h={...t,projection:{...s,width:c,height:l,scale:s.scale*n},samples:t.samples*n,peel:null,soft:!1};for(const p of r)p.draw(h);a.disable(a.BLEND);const f=new Float32Array(4*c*l);a.readPixels(0,0,c,l,a.RGBA,a.FLOAT,f);let d=0;for(let p=3;p<f.length;p+=4)d=Math.max(d,f[p]);const m=Math.max(1/64,Math.min(...r.map(p=>p.opacity)));return Math.min(o,Math.ceil(d/m+.5))}draw(t,e,o,a,r){const s=this.gl,n=t.projection.width,c=t.projection.height,l=e.filter(d=>d.translucent);for(const d of[this.opaque,this.sum])d.resize(n,c);if(l.length)for(const d of this.layers)d.resize(n,c);s.enable(s.SCISSOR_TEST);const[u,h]=r??[0,c];s.scissor(0,u,n,h-u),this.drawOpaque(t,e),this.sum.bind(),s.clearColor(0,0,0,0),s.clear(s.COLOR_BUFFER_BIT);let f=null;for(let d=0;d<(l.length?a.layers:0);++d){const m=this.layers[d%2],p=d>0?this.layers[(d+1)%2].depth:null;m.bind(),s.enable(s.DEPTH_TEST),s.depthFunc(s.LESS),s.depthMask(!0),s.disable(s.BLEND),s.clearColor(0,0,0,0),s.clearDepth(1),s.clear(s.COLOR_BUFFER_BIT|s.DEPTH_BUFFER_BIT);const x={before:p??this.nothing(),hiding:this.opaque.depth};for(const g of l)g.draw({...t,peel:x});for(const g of o)this.drawVolume(g,t,f,this.nearer(m,n,c),a.coarse);this.under(m.color),f=m.depth}for(const d of o)this.drawVolume(d,t,f,this.opaque.depth,a.coarse);this.under(this.opaque.color),s.disable(s.SCISSOR_TEST)}drawOpaque(t,e){const o=this.gl;this.opaque.bind(),o.enable(o.DEPTH_TEST),o.depthFunc(o.LESS),o.depthMask(!0),o.disable(o.BLEND),o.disable(o.CULL_FACE),o.disable(o.STENCIL_TEST),o.clearColor(0,0,0,0),o.clearDepth(1),o.clearStencil(0),o.clear(o.COLOR_BUFFER_BIT|o.DEPTH_BUFFER_BIT|o.STENCIL_BUFFER_BIT);for(const a of["surface","edges","marks"])for(const r of e)!r.translucent&&r.stage===a&&r.draw({...t,peel:null})}drawVolume(t,e,o,a,r){const s=this.gl;this.sum.bind(),s.disable(s.DEPTH_TEST),s.enable(s.BLEND),s.blendFunc(s.ONE_MINUS_DST_ALPHA,s.ONE),t.draw({...e,peel:null},o,a,r),s.disable(s.BLEND)}nearer(t,e,o){const a=this.gl;return this.limit??=new H(a,a.R32F,!1),this.limit.resize(e,o),this.limit.bind(),this.limiter??=new O(a,gt,`
uniform sampler2D uOne, uOther;
out vec4 oColor;
void main() { ivec2 at = ivec2(gl_FragCoord.xy); oColor = vec4(min(texelFetch(uOne, at, 0).r, texelFetch(uOther, at, 0).r)); }`),this.limiter.use(),this.limiter.texture("uOne",0,t.depth),this.limiter.texture("uOther",1,this.opaque.depth),a.disable(a.DEPTH_TEST),a.drawArrays(a.TRIANGLES,0,3),this.limit.color}under(t){const e=this.gl;this.sum.bind(),e.disable(e.DEPTH_TEST),e.enable(e.BLEND),e.blendFunc(e.ONE_MINUS_DST_ALPHA,e.ONE),this.copy.use(),this.copy.texture("uFrom",0,t),e.drawArrays(e.TRIANGLES,0,3),e.disable(e.BLEND)}nothing(){const t=this.gl,e=t.getParameter(t.FRAMEBUFFER_BINDING),o=this.zero??=new H(t,t.R8,!1);return o.resize(this.opaque.width,this.opaque.height),t.bindFramebuffer(t.FRAMEBUFFER,o.frame),t.clear(t.COLOR_BUFFER_BIT),t.bindFramebuffer(t.FRAMEBUFFER,e),o.color}finish(){const t=this.gl;this.sum.color&&(t.bindFramebuffer(t.FRAMEBUFFER,this.sum.frame),t.readPixels(0,0,1,1,t.RGBA,t.FLOAT,new Float32Array(4)))}present(t,e,o,a){const r=this.gl,s=this.resolve,n=this.scene;r.bindFramebuffer(r.FRAMEBUFFER,null),r.viewport(0,0,t,e),r.disable(r.DEPTH_TEST),r.disable(r.BLEND),r.disable(r.SCISSOR_TEST),s.use(),s.texture("uFrom",0,this.sum.color),s.f("uArea",o.x,o.y,o.width,o.height),s.f("uWindow",t,e),s.f("uSamples",a),s.f("uBottom",...n.background),s.f("uTop",...n.background_top),r.drawArrays(r.TRIANGLES,0,3)}}const P=(i,t)=>[i[0]+t[0],i[1]+t[1],i[2]+t[2]],C=(i,t)=>[i[0]-t[0],i[1]-t[1],i[2]-t[2]],L=(i,t)=>[i[0]*t,i[1]*t,i[2]*t],_=(i,t)=>i[0]*t[0]+i[1]*t[1]+i[2]*t[2],it=(i,t)=>[i[1]*t[2]-i[2]*t[1],i[2]*t[0]-i[0]*t[2],i[0]*t[1]-i[1]*t[0]],W=i=>Math.hypot(i[0],i[1],i[2]),B=i=>L(i,1/(W(i)||1));function xt(i,t,e){const o=Math.cos(e),a=Math.sin(e);return P(P(L(i,o),L(it(t,i),a)),L(t,_(t,i)*(1-o)))}const de=(i,t)=>[i[0]*t[0]+i[1]*t[1]+i[2]*t[2],i[3]*t[0]+i[4]*t[1]+i[5]*t[2],i[6]*t[0]+i[7]*t[1]+i[8]*t[2]];function me(i,t){const e=new Float32Array(4*i.lights.length);return i.lights.forEach((o,a)=>{const r=o.direction,s=o.follows?C(P(L(t.right,r[0]),L(t.up,r[1])),L(t.forward,r[2])):r;e.set([...B(s),o.intensity],4*a)}),e}function J(i,t){const e=t.projection;i.f("uEye",...C(e.eye,t.center)),i.f("uRight",...e.right),i.f("uUp",...e.up),i.f("uForward",...e.forward),i.f("uSize",e.width,e.height),i.f("uScale",e.scale),i.f("uNear",e.near),i.f("uFar",e.far),i.f("uSamples",t.samples),i.i("uParallel",e.parallel?1:0),i.i("uLampCount",Math.min(8,t.lamps.length/4)),i.gl.uniform4fv(i.place("uLamps"),t.lamps.subarray(0,32)),i.i("uPeeling",t.peel?1:0),i.texture("uBefore",6,t.peel?.before??null),i.texture("uHiding",7,t.peel?.hiding??null)}function Lt(i,t,e,o){const a=i.gl;if(e||!t.soft){i.i("uSoft",0),o();return}i.i("uSoft",1),o(),a.enable(a.BLEND),a.blendEquation(a.MAX),a.depthMask(!1),i.i("uSoft",2),o(),a.disable(a.BLEND),a.blendEquation(a.FUNC_ADD),a.depthMask(!0)}const pe=3e38;class ge{constructor(t,e,o){this.info=e,this.linear=new Float32Array(o.length);for(let r=0;r<o.length;++r)this.linear[r]=Kt(o[r]/65535);const a=new Float32Array(o.length/3*4);for(let r=0;r<o.length/3;++r){for(let s=0;s<3;++s)a[4*r+s]=this.linear[3*r+s];a[4*r+3]=1}this.texture=pt(t,a),this.ends=e.kind==="log"?[0,Math.log(e.hi/e.lo)]:e.kind==="symlog"?[wt(e.lo/e.threshold),wt(e.hi/e.threshold)]:[0,1]}stored(t){if(t!==t)return pe;if(this.info.labels.length||this.info.kind==="linear")return t;const e=this.ends[0]+t*(this.ends[1]-this.ends[0]);return this.info.kind==="log"?Math.exp(Math.min(e,85)):_t(e)}position(t){const e=this.info;if(e.labels.length){const o=e.labels.findIndex(a=>Math.fround(a)===Math.fround(t));return o<0?NaN:(o+.5)/e.labels.length}return e.lo===e.hi?t===e.lo?.5:t<e.lo?-1:2:e.kind==="log"?t>0?Math.log(t/e.lo)/Math.log(e.hi/e.lo):e.lo<=e.hi?-1:2:e.kind==="symlog"?(wt(t/e.threshold)-this.ends[0])/(this.ends[1]-this.ends[0]):(t-e.lo)/(e.hi-e.lo)}value(t){const e=this.info;return e.labels.length?e.labels[Math.min(e.labels.length-1,Math.max(0,Math.floor(t*e.labels.length)))]:e.kind==="log"?e.lo*(e.hi/e.lo)**t:e.kind==="symlog"?e.threshold*_t(this.ends[0]+t*(this.ends[1]-this.ends[0])):e.lo*(1-t)+e.hi*t}color(t){const e=this.position(t),o=this.info.size;if(e!==e)return this.info.nan;if(e<0)return this.info.below;if(e>1)return this.info.above;const a=3*Math.floor(e*(o-1)+.5);return[this.linear[a],this.linear[a+1],this.linear[a+2],1]}bind(t,e){const o=this.info;t.texture("uTable",e,this.texture),t.i("uTableSize",o.size),t.i("uScaleKind",o.labels.length||o.kind==="linear"?0:o.kind==="log"?1:2),t.f("uScaleEnds",...this.ends),t.f("uBelow",...o.below),t.f("uAbove",...o.above),t.f("uNan",...o.nan)}}const wt=i=>Math.abs(i)<=1?i:Math.sign(i)*(1+Math.log10(Math.abs(i))),_t=i=>Math.abs(i)<=1?i:Math.sign(i)*10**(Math.abs(i)-1);async function xe(i,t,e){return Promise.all(t.map(async o=>new ge(i,o,await e.get(o.colors))))}const Pt=i=>L(P(i.lo,i.hi),.5),kt=i=>W(C(i.hi,i.lo)),U=(i,t)=>[t&1?i.hi[0]:i.lo[0],t&2?i.hi[1]:i.lo[1],t&4?i.hi[2]:i.lo[2]];function st(i,t){const e=B(i);let o=it(e,B(t));if(!(W(o)>1e-9)){const a=e.map(Math.abs);o=it(e,a[1]<=a[0]&&a[1]<=a[2]?[0,1,0]:a[2]<=a[0]?[0,0,1]:[1,0,0])}return o=B(o),{right:o,up:it(o,e),forward:e}}class rt{constructor(t){this.position=[...t.position],this.target=[...t.target],this.up=[...t.up],this.angle=t.angle,this.parallel=t.parallel,this.height=t.height}set(t){Object.assign(this,t)}copy(){return new rt(this)}projection(t,e,o,a){const r=st(C(this.target,this.position),this.up),s=Math.min(e,t/o),n=this.parallel?s/this.height:.5*s/Math.tan(this.angle*Math.PI/360);let c=1/0,l=-1/0;for(let d=0;d<8;++d){const m=_(C(U(a,d),this.position),r.forward);c=Math.min(c,m),l=Math.max(l,m)}const u=.02*Math.max(l-c,.001*Math.max(Math.abs(l),Math.abs(c))),h=l>0?l+u:kt(a)||1,f=this.parallel?c-u:Math.max(c-u,.001*h);return{...r,width:t,height:e,parallel:this.parallel,eye:this.position,scale:n,near:f,far:h}}turn(t,e){const o=st(C(this.target,this.position),this.up),a=P(L(o.up,-t),L(o.right,-e)),r=W(a);if(!(r>0))return;const s=B(a);this.position=P(this.target,xt(C(this.position,this.target),s,r)),this.up=B(xt(o.up,s,r))}roll(t){this.up=xt(this.up,B(C(this.position,this.target)),t)}pan(t,e){const o=st(C(this.target,this.position),this.up),a=this.parallel?this.height:2*W(C(this.target,this.position))*Math.tan(this.angle*Math.PI/360),r=P(L(o.right,-t*a),L(o.up,e*a));this.position=P(this.position,r),this.target=P(this.target,r)}zoom(t){this.height/=t,this.position=P(this.target,L(C(this.position,this.target),1/t))}setParallel(t){if(t===this.parallel)return;const e=2*Math.tan(this.angle*Math.PI/360),o=C(this.position,this.target);t?this.height=W(o)*e:this.position=P(this.target,L(B(o),this.height/e)),this.parallel=t}fit(t,e,o,a,r){const s=Pt(t),n=kt(t)||1,c=st(L(e,-1),o),l=1-2*r,u=Array.from({length:8},(y,b)=>C(U(t,b),s)).map(y=>[_(y,c.right),_(y,c.up),_(y,c.forward)]);this.up=c.up;const h=Math.max(...u.map(y=>Math.abs(y[0]))),f=Math.max(...u.map(y=>Math.abs(y[1])));if(this.height=2*Math.max(f,h/a)/l||n,this.parallel){this.target=s,this.position=C(s,L(c.forward,2*n));return}const d=Math.tan(this.angle*Math.PI/360)*l,m=d*a,p=Math.max(...u.map(y=>y[0]-m*y[2])),x=Math.max(...u.map(y=>-y[0]-m*y[2])),g=Math.max(...u.map(y=>y[1]-d*y[2])),w=Math.max(...u.map(y=>-y[1]-d*y[2]));let v=Math.max((p+x)/(2*m),(g+w)/(2*d));v=Math.max(v,.05*n-Math.min(...u.map(y=>y[2]))),this.target=P(s,P(L(c.right,(p-x)/2),L(c.up,(g-w)/2))),this.position=C(this.target,L(c.forward,v))}}function Y(i,t){const e=C(t,i.eye),o=_(e,i.forward),a=i.parallel?i.scale:i.scale/o;return[.5*i.width+a*_(e,i.right),.5*i.height-a*_(e,i.up),o]}const Q=8;function we(i,t,e){const o=t.map(l=>Math.max(1,Math.ceil(l/Q))),a=o[0]*o[1]*o[2],r=new Float32Array(a).fill(1/0),s=new Float32Array(a).fill(-1/0),n=1/e,c=(l,u)=>[Math.max(0,Math.floor((l-1)/Q)),Math.min(o[u]-1,Math.floor((l+1)/Q))];for(let l=0;l<t[2];++l){const u=c(l,2);for(let h=0;h<t[1];++h){const f=c(h,1),d=t[0]*(h+t[1]*l);for(let m=0;m<o[0];++m){let p=65535,x=0;for(let g=Math.max(0,m*Q-1),w=Math.min(t[0],(m+1)*Q+1);g<w;++g){const v=i[d+g];v<p&&(p=v),v>x&&(x=v)}for(let g=u[0];g<=u[1];++g)for(let w=f[0];w<=f[1];++w){const v=m+o[0]*(w+o[1]*g);p*n<r[v]&&(r[v]=p*n),x*n>s[v]&&(s[v]=x*n)}}}}return{dims:o,lo:r,hi:s}}function ve(i,t){const[e,o,a]=i.dims,r=15,s=new Uint8Array(e*o*a);for(let c=0;c<s.length;++c)s[c]=t(i.lo[c],i.hi[c])?0:r;const n=c=>{const l=d=>Array.from({length:d},(m,p)=>c>0?p:d-1-p),u=l(e),h=l(o),f=l(a);for(const d of f)for(const m of h)for(const p of u){const x=p+e*(m+o*d);let g=s[x];if(g!==0){for(let w=-1;w<=1;++w)for(let v=-1;v<=1;++v)for(let y=-1;y<=1;++y){if((w*9+v*3+y)*c>=0)continue;const A=p+y,M=m+v,E=d+w;A<0||M<0||E<0||A>=e||M>=o||E>=a||(g=Math.min(g,s[A+e*(M+o*E)]+1))}s[x]=g}}};return n(1),n(-1),s}const z=`
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
`,ye=["composite","maximum","minimum","average","sum","first_hit","distance","accumulate","isosurface","maximum_difference"],be=`
void main() {
  vec2 p = vec2((gl_VertexID & 1) == 1 ? 3.0 : -1.0, (gl_VertexID & 2) == 2 ? 3.0 : -1.0);
  gl_Position = vec4(p, 0.0, 1.0);
}`,Me=i=>`
#define MODE ${i.mode===9?0:i.mode}
const bool uLit = ${i.lit}, uHasGaps = ${i.gaps}, uNearest = ${i.nearest}, uCells = ${i.cells}, uFast = ${i.fast};
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
}`;function et(i,t){if(i.length===0||t!==t)return 0;let e=0;for(;e<i.length&&i[e][0]<=t;)++e;if(e===0)return i[0][1];if(e===i.length)return i[e-1][1];const[o,a]=[i[e-1],i[e]];return o[1]+(a[1]-o[1])*(t-o[0])/(a[0]-o[0])}function Te(i,t,e){let o=Math.max(et(i,t),et(i,e));for(const[a,r]of i)a>=t&&a<=e&&(o=Math.max(o,r));return o}const Nt=4096;function Ee(i,t,e){const o=Nt,a=new Float32Array(4*o),r=new Float32Array(4*o),s=new Uint8Array(o),n=12/i.edge,c=[0,0,0,0];let l=[0,0,0,0];for(let u=0;u<o;++u){const h=i.least+(i.most-i.least)*u/(o-1),f=t.color(h),d=f[3]>0?Math.min(1,Math.max(0,et(e,h))):0,m=Math.min(n,-Math.log1p(-Math.min(d,1-1e-12))/i.unit);a.set([f[0],f[1],f[2],m],4*u);const p=[f[0]*m,f[1]*m,f[2]*m,m];if(u>0)for(let x=0;x<4;++x)c[x]+=.5*(l[x]+p[x])/(o-1);r.set(c,4*u),m>0&&(s[u]=1),l=p}for(const[u,h]of e){const f=Math.floor((u-i.least)/(i.most-i.least)*(o-1));if(h>0)for(const d of[f,f+1])d>=0&&d<o&&(s[d]=1)}return{medium:a,sums:r,seen:s}}function Ae(i){const t=new Uint32Array(i.length+1);for(let e=0;e<i.length;++e)t[e+1]=t[e]+i[e];return t}const Rt=new Map;function Se(i,t){const e=JSON.stringify(t);let o=Rt.get(e);return o||Rt.set(e,o=new O(i,be,Me(t))),o}function lt(i,t,e,o,a,r,s){const n=i.createTexture();i.activeTexture(i.TEXTURE0),i.bindTexture(i.TEXTURE_3D,n),i.pixelStorei(i.UNPACK_ALIGNMENT,1),i.texStorage3D(i.TEXTURE_3D,1,e,t[0],t[1],t[2]),i.texSubImage3D(i.TEXTURE_3D,0,0,0,0,t[0],t[1],t[2],o,a,r);for(const[c,l]of[[i.TEXTURE_MIN_FILTER,s],[i.TEXTURE_MAG_FILTER,s],[i.TEXTURE_WRAP_S,i.CLAMP_TO_EDGE],[i.TEXTURE_WRAP_T,i.CLAMP_TO_EDGE],[i.TEXTURE_WRAP_R,i.CLAMP_TO_EDGE]])i.texParameteri(i.TEXTURE_3D,c,l);return n}class ct{constructor(t,e,o,a){this.gl=t,this.info=e,this.scale=o,this.gaps=null,this.space=null,this.medium=null,this.sums=null,this.points=e.opacity.map(([r,s])=>[r,s]),this.origin=C(e.origin,a)}static async load(t,e,o,a,r){const s=new ct(t,e,a[e.scale],o),n=await r.get(e.array),c=e.nearest?t.NEAREST:t.LINEAR;if(e.bits===8)s.values=lt(t,e.dims,t.R8,t.RED,t.UNSIGNED_BYTE,n,c);else{const l=Float32Array.from(n,h=>h/65535),u=t.getExtension("OES_texture_float_linear")||e.nearest;s.values=lt(t,e.dims,u?t.R32F:t.R16F,t.RED,t.FLOAT,l,c)}if(e.left_out!==void 0){const l=e.cells?0:1;s.gaps=lt(t,e.dims.map(u=>u-l),t.R8,t.RED,t.UNSIGNED_BYTE,await r.get(e.left_out),t.NEAREST)}return s.bricks=we(n,e.dims,e.bits===8?255:65535),s.setOpacity(s.points),s}setOpacity(t){const e=this.gl,o=this.info;this.points=t;const a=Ee(o,this.scale,t),r=Ae(a.seen),s=Nt-1;e.deleteTexture(this.medium),e.deleteTexture(this.sums),e.deleteTexture(this.space),this.medium=pt(e,a.medium),this.sums=pt(e,a.sums);const n=o.levels.map(l=>(l-o.least)/(o.most-o.least)),c=(l,u)=>{if(o.mode==="isosurface")return n.some(d=>d>=l&&d<=u);if(o.mode==="first_hit")return u>=n[0];const h=Math.max(0,Math.floor(l*s)-1),f=Math.min(s,Math.ceil(u*s)+1);return r[f+1]>r[h]};this.space=lt(e,this.bricks.dims,e.R8,e.RED,e.UNSIGNED_BYTE,ve(this.bricks,c),e.NEAREST)}draw(t,e,o,a){const r=this.gl,s=this.info,n=s.to_u,c=Math.max(0,ye.indexOf(s.mode)),l=Se(r,{mode:c,lit:s.lit,gaps:this.gaps!==null,nearest:s.nearest,cells:s.cells,fast:t.moving});l.use(),J(l,t),l.texture("uLattice",0,this.values,r.TEXTURE_3D),l.texture("uDistance",1,this.space,r.TEXTURE_3D),l.texture("uLeftOut",2,this.gaps??this.values,r.TEXTURE_3D),l.texture("uMedium",3,this.medium),l.texture("uSums",4,this.sums),this.scale.bind(l,5),l.texture("uFront",6,e??o),l.texture("uBack",7,o),l.i("uHasFront",e?1:0),r.uniformMatrix3fv(l.place("uToU"),!1,[n[0],n[3],n[6],n[1],n[4],n[7],n[2],n[5],n[8]]),l.f("uOrigin",...this.origin),l.f("uLo",...s.lo),l.f("uHi",...s.hi),l.f("uDims",...s.dims),l.f("uSamplesAlong",...s.samples);const u=Math.max(...s.samples.map((d,m)=>d/s.dims[m]));l.f("uStep",.5*s.edge*u*a),l.f("uEdge",s.edge),l.f("uPerSurface",1/s.surface_from),l.f("uLeast",s.least),l.f("uMost",s.most);const h=s.levels.slice(0,8);l.i("uLevelCount",h.length),h.length&&(r.uniform1fv(l.place("uLevels"),h),r.uniform1fv(l.place("uLevelOpacity"),h.map(d=>et(this.points,d))));const f=[];for(let d=0;d+3<s.clip.length&&f.length<48;d+=4){const m=s.clip.slice(d,d+3);f.push(...m,s.clip[d+3]-(m[0]*t.center[0]+m[1]*t.center[1]+m[2]*t.center[2]))}l.i("uPlaneCount",f.length/4),f.length&&r.uniform4fv(l.place("uPlanes"),f),l.f("uMaterial",...s.material),l.f("uScaleLo",this.scale.info.lo),l.f("uScaleHi",this.scale.info.hi),l.f("uThreshold",this.scale.info.threshold),r.drawArrays(r.TRIANGLES,0,3)}}async function ht(i,t,e){const o=await e.get(i.array),a=new Float32Array(o.length),r=2**i.bits-1,s=[0,1,2].map(c=>i.origin[c]-t[c]+i.lo[c]),n=i.size.map(c=>c/r);for(let c=0;c<o.length;++c)a[c]=s[c%3]+n[c%3]*o[c];return a}async function Dt(i,t){const e=await t.get(i.array),o=2**i.bits-1,a=new Float32Array(e.length/2*3);for(let r=0;r<e.length/2;++r){let s=2*e[2*r]/o-1,n=2*e[2*r+1]/o-1;const c=1-Math.abs(s)-Math.abs(n);if(c<0){const u=(1-Math.abs(n))*(s<0?-1:1);n=(1-Math.abs(s))*(n<0?-1:1),s=u}const l=Math.hypot(s,n,c)||1;a[3*r]=s/l,a[3*r+1]=n/l,a[3*r+2]=c/l}return a}function Fe(i,t,e,o){const a=2**t-1,r=2**t/16,s=a-r,n=new Float64Array(i.length);for(let c=0;c<i.length;++c){const l=i[c];n[c]=l===0?NaN:l<r?e-e*(l-1)/(r-1):l<=s?(l-r)/(s-r):1+(o-1)*(l-s)/(a-s)}return n}class G{constructor(t,e){this.info=t,this.values=null,this.colors=null,this.perCell=t.kind!=="constant"&&t.per_cell,this.nearest=t.kind==="scale"&&t.nearest,this.scale=t.kind==="scale"?e[t.scale]:null}static async load(t,e,o){const a=new G(t,e);if(t.kind==="direct"&&(a.colors=await o.get(t.colors.array)),t.kind==="scale"){const r=Fe(await o.get(t.positions.array),t.positions.bits,t.positions.least,t.positions.most);a.values=Float32Array.from(r,s=>a.scale.stored(s))}return a}bind(t,e,o){t.i("uColoring",this.values?1:this.colors?2:0),t.f("uConstant",...this.info.kind==="constant"?this.info.rgba:[1,1,1,1]),t.f("uOpacity",o),this.scale?this.scale.bind(t,e):t.texture("uTable",e,null)}}const Ce=`
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
}`,Le=`
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
}`;let _e=null;const Pe=i=>_e??=new O(i,Ce,Le);class vt{constructor(t,e,o,a){this.gl=t,this.look=e,this.coloring=o,this.s=a,this.count=a.from.length/3,this.translucent=e.opacity<1,this.opacity=e.opacity,this.stage=a.room&&!this.translucent?"edges":"marks",this.list=t.createVertexArray(),t.bindVertexArray(this.list);const r=(s,n,c)=>n&&F(t,s,n,c,1);r(0,a.from,3),r(1,a.to,3),r(2,a.values,2),r(5,a.tangentsFrom,3),r(6,a.tangentsTo,3),r(7,a.room,1),r(8,a.places,3),a.colorsFrom&&F(t,3,a.colorsFrom,4,1,t.UNSIGNED_BYTE,!0),a.colorsTo&&F(t,4,a.colorsTo,4,1,t.UNSIGNED_BYTE,!0),t.bindVertexArray(null)}draw(t){const e=this.gl,o=Pe(e),a=this.look,r=this.stage==="edges",s=r?this.wholeFade(t):1;s>0&&(o.use(),J(o,t),this.coloring.bind(o,0,a.opacity),o.f("uMaterial",...a.material),o.f("uHalf",Math.max(.5,.5*a.width*t.samples)),o.f("uHalo",a.halo*t.samples),o.f("uHaloColor",...a.haloColor),o.f("uWholeFade",s),o.i("uLit",a.lit?1:0),o.i("uNearest",this.coloring.nearest?1:0),o.i("uInPixels",a.inPixels?1:0),o.i("uRoomy",this.s.room?1:0),o.i("uContrast",t.peel||a.contrast==="none"?0:a.contrast==="darker"?1:2),r&&(e.enable(e.BLEND),e.blendFunc(e.ONE,e.ONE_MINUS_SRC_ALPHA),e.enable(e.STENCIL_TEST),e.stencilFunc(e.EQUAL,0,255),e.stencilOp(e.KEEP,e.KEEP,e.INCR),e.depthMask(!1)),e.bindVertexArray(this.list),Lt(o,t,r||this.translucent,()=>e.drawArraysInstanced(e.TRIANGLE_STRIP,0,4,this.count)),e.bindVertexArray(null),r&&(e.disable(e.BLEND),e.disable(e.STENCIL_TEST),e.depthMask(!0)))}wholeFade(t){const{from:e,to:o,room:a}=this.s,r=t.projection,s=Math.max(1,Math.floor(this.count/4e3));let n=0,c=0;for(let u=0;u<this.count;u+=s){const h=[0,1].map(m=>{const p=m?o:e;return[0,1,2].reduce((x,g)=>x+(p[3*u+g]+t.center[g]-r.eye[g])*r.forward[g],0)}),f=(r.parallel?r.scale:r.scale/Math.max(.5*(h[0]+h[1]),1e-30))/t.samples,d=Math.hypot(o[3*u]-e[3*u],o[3*u+1]-e[3*u+1],o[3*u+2]-e[3*u+2]);a[u]*f>3?++c:d*f<8&&++n}const l=n/Math.max(1,n+c);return Math.min(1,Math.max(0,(.5-l)/.25))}}function ke(i,t){const e=t.length/2,o=new Float32Array(3*e),a=new Float32Array(3*e),r=new Float32Array(3*e),s=(n,c,l,u,h)=>{const f=Math.hypot(l,u,h)||1;n[3*c]=l/f,n[3*c+1]=u/f,n[3*c+2]=h/f};for(let n=0;n<e;++n){const c=3*t[2*n],l=3*t[2*n+1];s(o,n,i[l]-i[c],i[l+1]-i[c+1],i[l+2]-i[c+2])}for(let n=0;n<e;++n){const c=n>0&&t[2*n-1]===t[2*n]?n-1:n,l=n+1<e&&t[2*n+1]===t[2*n+2]?n+1:n;s(a,n,o[3*c]+o[3*n],o[3*c+1]+o[3*n+1],o[3*c+2]+o[3*n+2]),s(r,n,o[3*l]+o[3*n],o[3*l+1]+o[3*n+1],o[3*l+2]+o[3*n+2])}return[a,r]}async function Ne(i,t,e,o,a){const r=await G.load(t.color,o,a),s=await ht(t.positions,e,a),n=await a.get(t.segments),c=n.length/2,l={from:new Float32Array(3*c),to:new Float32Array(3*c)};for(let h=0;h<c;++h)for(let f=0;f<3;++f)l.from[3*h+f]=s[3*n[2*h]+f],l.to[3*h+f]=s[3*n[2*h+1]+f];const u=(h,f)=>r.perCell?h:n[2*h+f];if(r.values&&(l.values=Float32Array.from({length:2*c},(h,f)=>r.values[u(f>>1,f&1)])),r.colors){l.colorsFrom=new Uint8Array(4*c),l.colorsTo=new Uint8Array(4*c);for(let h=0;h<c;++h)for(let f=0;f<4;++f)l.colorsFrom[4*h+f]=r.colors[4*u(h,0)+f],l.colorsTo[4*h+f]=r.colors[4*u(h,1)+f]}return t.lit&&([l.tangentsFrom,l.tangentsTo]=ke(s,n)),t.room!==void 0&&(l.room=await a.get(t.room)),new vt(i,{width:t.width,opacity:t.opacity,lit:t.lit,material:t.material,contrast:t.contrast,halo:t.halo,haloColor:t.halo_color,inPixels:!1},r,l)}const Re=`
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
}`,zt=`
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
}`,De=`
in vec3 vPlace, vNormal, vValues, vCorner;
in float vValue;
in vec4 vColor;
uniform bool uNearest;
${z}${Z}${tt}${V}${nt}${zt}
void main() {
  vec4 color = uConstant;
  float value = vValue;
  if (uNearest) value = vCorner.x >= vCorner.y && vCorner.x >= vCorner.z ? vValues.x : vCorner.y >= vCorner.z ? vValues.y : vValues.z;
  if (uColoring == 1) color = scaleColor(value);
  if (uColoring == 2) color = vColor;
  shadeSurface(vPlace, vNormal, color);
}`;let ze=null;const Ie=i=>ze??=new O(i,Re,De);function ot(i,t,e){const o=new i.constructor(t.length*e);for(let a=0;a<t.length;++a)for(let r=0;r<e;++r)o[e*a+r]=i[e*t[a]+r];return o}class yt{constructor(t,e,o){this.gl=t,this.info=e,this.coloring=o,this.stage="surface",this.count=0,this.indexed=!1,this.smooth=!1,this.translucent=e.translucent,this.opacity=e.opacity,this.list=t.createVertexArray()}static async load(t,e,o,a,r){const s=await G.load(e.color,a,r),n=new yt(t,e,s);let c=await ht(e.positions,o,r);const l=await r.get(e.triangles);let u=e.normals?await Dt(e.normals,r):null,h=s.values,f=s.colors;const d=e.corners!==void 0||s.perCell||s.nearest;let m=null;if(d){c=ot(c,l,3),u&&(u=ot(u,e.corners!==void 0?await r.get(e.corners):l,3));const p=s.perCell?Uint32Array.from(l,(x,g)=>Math.floor(g/3)):l;h&&(h=ot(h,p,1)),f&&(f=ot(f,p,4)),h&&s.nearest&&(m=ot(h,Uint32Array.from({length:3*h.length},(x,g)=>Math.floor(g/9)*3+g%3),1))}return t.bindVertexArray(n.list),F(t,0,c,3),u&&F(t,1,u,3),h&&F(t,2,h,1),f&&F(t,3,f,4,0,t.UNSIGNED_BYTE,!0),m&&F(t,4,m,3),d||(t.bindBuffer(t.ELEMENT_ARRAY_BUFFER,t.createBuffer()),t.bufferData(t.ELEMENT_ARRAY_BUFFER,l,t.STATIC_DRAW)),t.bindVertexArray(null),n.indexed=!d,n.count=l.length,n.smooth=u!==null,h&&(s.values=new Float32Array(0)),f&&(s.colors=new Uint8Array(0)),n}draw(t){const e=this.gl,o=Ie(e);o.use(),J(o,t),this.coloring.bind(o,0,this.info.opacity),o.f("uMaterial",...this.info.material),o.i("uLit",this.info.lit?1:0),o.i("uSmooth",this.smooth?1:0),o.i("uNearest",this.coloring.nearest&&!this.coloring.perCell?1:0),e.bindVertexArray(this.list),this.indexed?e.drawElements(e.TRIANGLES,this.count,e.UNSIGNED_INT,0):e.drawArrays(e.TRIANGLES,0,this.count),e.bindVertexArray(null)}}const Oe=`
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
}`,Be=`
in vec3 vPlace, vNormal;
flat in float fValue;
flat in vec4 fColor;
${z}${Z}${tt}${V}${nt}${zt}
void main() {
  shadeSurface(vPlace, vNormal, uColoring == 1 ? scaleColor(fValue) : uColoring == 2 ? fColor : uConstant);
}`;let Ue=null;function Ve(i,t,e){const o=[];for(let a=0;a<e;++a)(t?t[a]:0)===i&&o.push(a);return Uint32Array.from(o)}function at(i,t,e){const o=new i.constructor(t.length*e);return t.forEach((a,r)=>{for(let s=0;s<e;++s)o[e*r+s]=i[e*a+s]}),o}class bt{constructor(t,e,o){this.gl=t,this.info=e,this.coloring=o,this.stage="surface",this.lists=[],this.translucent=e.translucent,this.opacity=e.opacity}static async load(t,e,o,a,r){const s=await G.load(e.color,a,r),n=await ht(e.places,o,r),c=await r.get(e.matrices),l=n.length/3,u=new Float32Array(c.length);for(let m=0;m<c.length;++m)u[m]=(c[m]-32767)*e.largest;const h=e.choice!==void 0?await r.get(e.choice):null,f=await Promise.all(e.shapes.map(async m=>({points:await r.get(m.positions),normals:m.normals!==void 0?await r.get(m.normals):null})));if(e.kind==="glyph_lines")return $e(t,e,s,n,u,f.map(m=>m.points),h);const d=new bt(t,e,s);return f.forEach((m,p)=>{const x=Ve(p,h,l);if(x.length===0||m.points.length===0)return;const g=t.createVertexArray(),w=at(u,x,9);t.bindVertexArray(g),F(t,0,m.points,3),m.normals&&F(t,1,m.normals,3),s.values&&F(t,2,at(s.values,x,1),1,1),s.colors&&F(t,3,at(s.colors,x,4),4,1,t.UNSIGNED_BYTE,!0),F(t,4,at(n,x,3),3,1);for(let v=0;v<3;++v)F(t,5+v,at(w,Uint32Array.from(x,(y,b)=>3*b+v),3),3,1);t.bindVertexArray(null),d.lists.push({list:g,corners:m.points.length/3,count:x.length})}),d}draw(t){const e=this.gl,o=Ue??=new O(e,Oe,Be);o.use(),J(o,t),this.coloring.bind(o,0,this.info.opacity),o.f("uMaterial",...this.info.material),o.i("uLit",this.info.lit?1:0),o.i("uSmooth",1),o.i("uInPixels",this.info.in_pixels?1:0);for(const{list:a,corners:r,count:s}of this.lists)e.bindVertexArray(a),e.drawArraysInstanced(e.TRIANGLES,0,r,s);e.bindVertexArray(null)}}function $e(i,t,e,o,a,r,s){const n=o.length/3;let c=0;for(let h=0;h<n;++h)c+=r[s?s[h]:0].length/6;const l={from:new Float32Array(3*c),to:new Float32Array(3*c),places:new Float32Array(3*c)};e.values&&(l.values=new Float32Array(2*c)),e.colors&&(l.colorsFrom=new Uint8Array(4*c),l.colorsTo=new Uint8Array(4*c));let u=0;for(let h=0;h<n;++h){const f=r[s?s[h]:0];for(let d=0;d<f.length/6;++d,++u){for(let m=0;m<3;++m){for(const[p,x]of[[l.from,6*d],[l.to,6*d+3]])p[3*u+m]=[0,1,2].reduce((g,w)=>g+a[9*h+3*m+w]*f[x+w],0);l.places[3*u+m]=o[3*h+m]}if(l.values&&(l.values[2*u]=l.values[2*u+1]=e.values[h]),l.colorsFrom)for(const m of[l.colorsFrom,l.colorsTo])m.set(e.colors.subarray(4*h,4*h+4),4*u)}}return new vt(i,{width:t.width,opacity:t.opacity,lit:!1,material:t.material,contrast:"none",halo:0,haloColor:[0,0,0],inPixels:t.in_pixels},e,l)}const He=`
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
}`,Ge=`
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
}`;let je=null;class Mt{constructor(t,e,o){this.gl=t,this.info=e,this.coloring=o,this.stage="marks",this.count=0,this.translucent=e.opacity<1,this.opacity=e.opacity,this.list=t.createVertexArray()}static async load(t,e,o,a,r){const s=new Mt(t,e,await G.load(e.color,a,r)),n=await ht(e.positions,o,r),c=e.normals?await Dt(e.normals,r):null,l=e.radii!==void 0?await r.get(e.radii):null;return t.bindVertexArray(s.list),F(t,0,n,3,1),c&&F(t,1,c,3,1),s.coloring.values&&F(t,2,s.coloring.values,1,1),s.coloring.colors&&F(t,3,s.coloring.colors,4,1,t.UNSIGNED_BYTE,!0),l&&F(t,4,l,1,1),t.bindVertexArray(null),s.count=n.length/3,s}draw(t){const e=this.gl,o=je??=new O(e,He,Ge);o.use(),J(o,t),this.coloring.bind(o,0,this.info.opacity),o.f("uMaterial",...this.info.material),o.f("uHalf",Math.max(.5,.5*this.info.size*t.samples)),o.i("uDiscs",this.info.kind==="discs"?1:0),o.i("uLit",this.info.lit?1:0),e.bindVertexArray(this.list),Lt(o,t,this.translucent||this.info.kind==="discs",()=>e.drawArraysInstanced(e.TRIANGLE_STRIP,0,4,this.count)),e.bindVertexArray(null)}}function ut(i,t){for(let e=0;e<3;++e)i.lo[e]=Math.min(i.lo[e],t[e]),i.hi[e]=Math.max(i.hi[e],t[e])}function Xe(i,t){if(t.kind==="volume"){const a=t.to_u,r=a[0]*(a[4]*a[8]-a[5]*a[7])-a[1]*(a[3]*a[8]-a[5]*a[6])+a[2]*(a[3]*a[7]-a[4]*a[6]),s=[a[4]*a[8]-a[5]*a[7],a[2]*a[7]-a[1]*a[8],a[1]*a[5]-a[2]*a[4],a[5]*a[6]-a[3]*a[8],a[0]*a[8]-a[2]*a[6],a[2]*a[3]-a[0]*a[5],a[3]*a[7]-a[4]*a[6],a[1]*a[6]-a[0]*a[7],a[0]*a[4]-a[1]*a[3]].map(n=>n/r);for(let n=0;n<8;++n){const c=de(s,U({lo:t.lo,hi:t.hi},n));ut(i,[c[0]+t.origin[0],c[1]+t.origin[1],c[2]+t.origin[2]])}return}const e="places"in t?t.places:t.positions,o="places"in t&&!t.in_pixels?t.largest*32767:0;for(let a=0;a<8;++a)ut(i,[0,1,2].map(r=>e.origin[r]+e.lo[r]+(a>>r&1?e.size[r]+o:-o)))}const It=i=>i.box?{lo:i.box.slice(0,3),hi:i.box.slice(3)}:null;function Ot(i,t){const e={lo:[1/0,1/0,1/0],hi:[-1/0,-1/0,-1/0]},o=It(t);o&&(ut(e,o.lo),ut(e,o.hi));for(const a of i)Xe(e,a);return e.lo[0]<=e.hi[0]?e:{lo:[-.5,-.5,-.5],hi:[.5,.5,.5]}}async function qe(i,t,e,o,a,r){const{items:s,annotation:n,time:c}=t.steps[e],l=[],u=[],h=await Promise.all(s.map(f=>{switch(f.kind){case"surface":return yt.load(i,f,o,a,r);case"lines":return Ne(i,f,o,a,r);case"points":case"discs":return Mt.load(i,f,o,a,r);case"volume":return ct.load(i,f,o,a,r);default:return bt.load(i,f,o,a,r)}}));for(const f of h)f instanceof ct?l.push(f):u.push(f);return{annotation:n,box:It(n),bounds:Ot(s,n),drawables:u,volumes:l,time:c}}class We{constructor(t,e,o){this.gl=t,this.box=e,this.center=o,this.key=-1,this.lines=null,this.coloring=null}async load(t){this.coloring=await G.load({kind:"constant",rgba:[.4341536,.4341536,.462077,1]},[],t)}at(t){const e=(s,n)=>t.parallel?(n?-1:1)*-t.forward[s]>=0:n?t.eye[s]<=this.box.hi[s]:t.eye[s]>=this.box.lo[s];let o=0;for(let s=0;s<3;++s)o|=(e(s,!1)?1<<2*s:0)|(e(s,!0)?2<<2*s:0);if(o===this.key||!this.coloring)return this.lines;const a=[],r=[];for(let s=0;s<8;++s)for(let n=0;n<3;++n){const c=(n+1)%3,l=(n+2)%3;s>>n&1||!(this.box.hi[n]>this.box.lo[n])||!e(c,(s>>c&1)===1)&&!e(l,(s>>l&1)===1)||(a.push(...C(U(this.box,s),this.center)),r.push(...C(U(this.box,s|1<<n),this.center)))}return this.key=o,this.lines=a.length===0?null:new vt(this.gl,{width:1,opacity:1,lit:!1,material:[1,0,0,1],contrast:"none",halo:0,haloColor:[0,0,0],inPixels:!1},this.coloring,{from:Float32Array.from(a),to:Float32Array.from(r)}),this.lines}}const $=(i,t)=>i.x<t.x+t.width&&t.x<i.x+i.width&&i.y<t.y+t.height&&t.y<i.y+i.height,j=(i,t)=>({x:i.x-t,y:i.y-t,width:i.width+2*t,height:i.height+2*t}),Bt=(i,t)=>Math.max(432,Math.min(t,.8*i));function Ye(i,t,e){const o=Bt(t,e)/Bt(i.width,i.height),[a,r,s,n]=i.area,c=Math.round(a*o),l=Math.round(r*o),u=Math.round((i.width-a-s)*o),h=Math.round((i.height-r-n)*o),f=(c+u)*2>t,d=(l+h)*2>e,m={x:f?0:c,y:d?0:l,width:Math.max(1,f?t:t-c-u),height:Math.max(1,d?e:e-l-h)};return{width:t,height:e,factor:o,area:m}}function Ut(i,t,e,o){return o.parallel?(e?-1:1)*o.forward[t]>1e-9:e?o.eye[t]>i.hi[t]:o.eye[t]<i.lo[t]}function Ke(i,t){const e=[],o=[0,0],a=[];for(let r=0;r<8;++r){const s=Y(t,U(i,r));if(!t.parallel&&!(s[2]>0))return a;e.push([s[0],s[1]]),o[0]+=s[0]/8,o[1]+=s[1]/8}for(let r=0;r<3;++r){const s=(r+1)%3,n=(r+2)%3;let c=-1/0,l=null;for(let u=0;u<4;++u){const h=(u&1)===1,f=(u&2)===2;if(Ut(i,s,h,t)===Ut(i,n,f,t))continue;const d=(h?1<<s:0)|(f?1<<n:0),m=d|1<<r,p=[e[m][0]-e[d][0],e[m][1]-e[d][1]],x=Math.hypot(...p);if(x<24)continue;const g=[.5*(e[d][0]+e[m][0])-o[0],.5*(e[d][1]+e[m][1])-o[1]];let w=[p[1]/x,-p[0]/x];w[0]*g[0]+w[1]*g[1]<0&&(w=[-w[0],-w[1]]);const v=.85*w[1]-.5*w[0];v>c&&(c=v,l={axis:r,from:U(i,d),to:U(i,m),outward:w})}l&&a.push(l)}return a}function Tt(i,t,e,o){const a=Math.abs(t[0])*.5*e+Math.abs(t[1])*.5*o;return{x:i[0]+t[0]*a-.5*e,y:i[1]+t[1]*a-.5*o,width:e,height:o}}function Je(i,t,e,o,a,r){if(!t.axes||!t.axis)return;const s=h=>h.x>=2&&h.y>=2&&h.x+h.width<=o.width-2&&h.y+h.height<=o.height-2&&!r.some(f=>$(f,h)),n=.88*a,c=Math.max(1,.08*a),l=Ke(e,o).map(h=>{const f=Y(o,h.from),d=Y(o,h.to),m=Math.hypot(d[0]-f[0],d[1]-f[1]);let p=[];for(let x=Math.floor(Math.max(2,Math.min(7,m/(3.5*a))));x>=1;--x){let g=!0;p=[];for(const w of t.axis[h.axis].ticks[x-1]){const v=[...h.from];v[h.axis]=w.at;const y=Y(o,v),b=i.measure(w.text,{size:n}),A=[y[0],y[1]],M=Tt([A[0]+h.outward[0]*.85*a,A[1]+h.outward[1]*.85*a],h.outward,b.width,b.height);g=g&&!p.some(E=>$(j(E.rect,.12*a),M)),p.push({at:A,text:w.text,rect:M})}if(g)break}return{axis:h,ticks:p,from:f,to:d}});for(const h of l){const f=t.axis[h.axis.axis].name;if(!f)continue;const d=[...r,...l.filter(b=>b!==h).flatMap(b=>b.ticks.map(A=>j(A.rect,1)))],m=[.5*(h.from[0]+h.to[0]),.5*(h.from[1]+h.to[1])],p=[h.to[0]-h.from[0],h.to[1]-h.from[1]],x=h.axis.outward,g=(b,A)=>{let M=.9*a;for(const E of h.ticks){const k=E.rect.x+.5*E.rect.width,S=E.rect.y+.5*E.rect.height,K=Math.abs(x[0])*.5*E.rect.width+Math.abs(x[1])*.5*E.rect.height;M=Math.max(M,(k-E.at[0])*x[0]+(S-E.at[1])*x[1]+K+.85*a)}for(const E of[M,M*.75,M*.5,M*1.4])for(const k of[0,.1,-.1,.2,-.2,.3,-.3,.42,-.42,.5,-.5]){const S=Tt([m[0]+p[0]*k+x[0]*E,m[1]+p[1]*k+x[1]*E],x,b,A),K={x:S.x-.8*a,y:S.y-.3*a,width:S.width+1.6*a,height:S.height+.6*a};if(!(h.ticks.some(X=>$(X.rect,K))||d.some(X=>$(X,S)))&&S.x>=2&&S.y>=2&&S.x+S.width<=o.width-2&&S.y+S.height<=o.height-2)return S}return null},w=i.measure(f,{size:a});let v=g(w.width,w.height);if((!v||v.x<.6*a||v.x+v.width>o.width-.6*a)&&Math.abs(p[1])>3*Math.abs(p[0])){const b=g(w.height,w.width);if(b){i.turned(f,b.x+.5*b.width,b.y+.5*b.height,Math.PI/2,{size:a,halo:!0}),r.push(b);continue}}v&&(i.text(f,v.x,v.y,{size:a,halo:!0}),r.push(v))}const u=[];for(const h of l){const f=h.axis.outward,d=[];i.line(h.from[0],h.from[1],h.to[0],h.to[1],c,i.ink,.9);const m=Math.hypot(h.to[0]-h.from[0],h.to[1]-h.from[1])||1,p=[(h.to[0]-h.from[0])/m,(h.to[1]-h.from[1])/m];for(const x of h.ticks){i.line(x.at[0],x.at[1],x.at[0]+f[0]*.5*a,x.at[1]+f[1]*.5*a,c,i.ink,.9);const g=((x.at[0]-h.from[0])*p[0]+(x.at[1]-h.from[1])*p[1])/m,w=Math.abs(g-.5)<.25?[0,0]:g<.5?p:[-p[0],-p[1]],v=[[0,0],[w[0]*.45,w[1]*.45],[w[0]*.9,w[1]*.9],[f[0]*.4+w[0]*.6,f[1]*.4+w[1]*.6],[f[0]*.8,f[1]*.8],[f[0]*1.2,f[1]*1.2],[-.7,.1],[.7,.1],[-1.4,.3],[1.4,.3],[f[0]*1.7,f[1]*1.7]];for(const y of v){const b={...x.rect,x:x.rect.x+y[0]*a,y:x.rect.y+y[1]*a},A={x:b.x-.7*a,y:b.y-.15*a,width:b.width+1.4*a,height:b.height+.3*a};if(!(!s(j(b,.3*a))||u.some(M=>$(M,A)))){i.text(x.text,b.x,b.y,{size:n,halo:!0}),r.push(b),d.push(b);break}}}u.push(...d)}}const Qe=["rgb(255 107 97)","rgb(115 217 102)","rgb(115 158 255)"],Ze=["rgb(204 38 38)","rgb(26 133 38)","rgb(31 82 204)"];function Vt(i,t){const e=7.6000000000000005*t;return{x:.6*t,y:i-e-.6*t,width:e,height:e}}function to(i,t,e,o){const a=Vt(e.height,o),r=a.x+.5*a.width,s=a.y+.5*a.height,n=[0,1,2].map(l=>{const u=[0,0,0];return u[l]=t.stretch[l]<0?-1:1,{axis:l,d:[_(u,e.right),-_(u,e.up)],depth:_(u,e.forward)}}).sort((l,u)=>u.depth-l.depth),c=[n.reduce((l,u)=>l+u.d[0],0),n.reduce((l,u)=>l+u.d[1],0)];for(const l of n){const u=(t.dark?Qe:Ze)[l.axis],h=Math.hypot(...l.d),f=[r+l.d[0]*2.7*o,s+l.d[1]*2.7*o];let d;if(h>.05){d=[l.d[0]/h,l.d[1]/h];const w=Math.min(.75*o,.8*h*2.7*o),v=[f[0]-d[0]*w,f[1]-d[1]*w],y=.3*o;i.line(r,s,v[0],v[1],Math.max(1.5,.16*o),u),i.polygon([f,[v[0]-d[1]*y,v[1]+d[0]*y],[v[0]+d[1]*y,v[1]-d[0]*y]],u)}else{const w=i.context,v=Math.hypot(...c);w.fillStyle=u,w.beginPath(),w.arc(r,s,.28*o,0,2*Math.PI),w.fill(),d=v>.05?[-c[0]/v,-c[1]/v]:[-.7071,.7071]}const m=t.axis?.[l.axis].letter??"xyz"[l.axis];if(!m||m.length>3)continue;const p=i.measure(m,{size:o,bold:!0}),x=h>.05?f:[r+d[0]*.25*o,s+d[1]*.25*o],g=Tt([x[0]+d[0]*.05*o,x[1]+d[1]*.05*o],d,p.width,p.height);i.text(m,g.x,g.y,{size:o,bold:!0,color:u})}}class eo{constructor(t,e,o){this.l=t,this.a=e,this.at=o}x(t){const{factor:e,width:o}=this.at;return this.l.place==="right"?o-(this.a.width-t)*e:this.l.place==="left"?t*e:.5*o+(t-.5*this.a.width)*e}y(t){const{factor:e,height:o}=this.at;return this.l.place==="top"?t*e:this.l.place==="bottom"?o-(this.a.height-t)*e:.5*o+(t-.5*this.a.height)*e}rect(t){const e=Math.round(this.x(t[0])),o=Math.round(this.y(t[1])),a=this.at.factor;return{x:e,y:o,width:Math.round(t[2]*a),height:Math.round(t[3]*a)}}length(t){return t*this.at.factor}}const I=(i,t,e,o,a,r)=>{t[3]!==0&&(i.fillStyle=q(t),i.fillRect(e,o,a,r))};function oo(i,t,e,o,a,r){const s=new eo(t,e,o),n=s.length(t.font);if(t.title){const c={size:s.length(t.title_size),wrap:s.length(t.title_wrap),centred:t.title_centred};if(t.title_upwards){const[l,u]=t.title_extent;i.turned(t.title,s.x(t.title_at[0]+.5*u),s.y(t.title_at[1]+.5*l),Math.PI/2,{...c,halo:!0})}else i.text(t.title,s.x(t.title_at[0]),s.y(t.title_at[1]),{...c,halo:!0})}if(t.colors?ao(i,t,s,n):io(i,t,s,n),t.panel&&t.scale!==void 0&&so(i,t,s,n,a[t.scale],r??t.opacity??[]),t.glyph&&ro(i,t,s,n),t.nan){const c=Math.round(s.x(t.nan_at[0])),l=Math.round(s.y(t.nan_at[1])),u=Math.round(1.3*n);I(i.context,t.nan_color,c,l,u,Math.round(.9*n)),i.frame(c,l,u,Math.round(.9*n)),i.text("NaN",c+u+.75*n,l-.15*n,{size:n,halo:!0})}return s.rect(t.column)}function ao(i,t,e,o){const a=i.context,r=e.rect(t.bar),s=t.colors,n=t.place==="top"||t.place==="bottom",c=n?r.width:r.height,l=s.length/4;for(let y=0;y<c;++y){const b=4*Math.min(l-1,c===l?y:Math.round(y/Math.max(1,c-1)*(l-1))),A=s.slice(b,b+4);n?I(a,A,r.x+y,r.y,1,r.height):I(a,A,r.x,r.y+y,r.width,1)}i.frame(r.x,r.y,r.width,r.height);const u=r.x+r.width,h=r.y+r.height,f=o,d=r.x+.5*r.width,m=r.y+.5*r.height;t.above&&i.polygon(n?[[u+2,r.y],[u+2+f,m],[u+2,h]]:[[r.x,r.y-2],[d,r.y-2-f],[u,r.y-2]],q(t.above),!0),t.below&&i.polygon(n?[[r.x-2,r.y],[r.x-2-f,m],[r.x-2,h]]:[[r.x,h+2],[d,h+2+f],[u,h+2]],q(t.below),!0);const p=Math.max(1,.07*o),x=.5*i.measure("0",{size:o}).height,[g,w]=[t.bar[0],t.bar[1]],v=Math.max(1,l-1);for(const y of t.ticks){const b=(y.at-(n?g:w))/v,A=(n?r.x:r.y)+Math.round(b*(c-1))+.5;n?(i.line(A,h,A,h+.35*o,p,i.ink,.9),i.text(y.text,A-.5*i.measure(y.text,{size:o}).width,h+.45*o,{size:o,halo:!0})):(i.line(u,A,u+.35*o,A,p,i.ink,.9),i.text(y.text,u+.75*o,A-x,{size:o,halo:!0}))}}function io(i,t,e,o){const a=e.rect(t.bar),r=e.length(t.row_height),s=e.length(t.row_width),n=Math.round(1.3*o);t.rows.forEach((c,l)=>{const u=a.x+l%t.across*s,h=a.y+Math.floor(l/t.across)*r;if(l<t.swatches.length){const f=Math.round(h+.12*r),d=Math.round(.76*r);I(i.context,t.swatches[l],Math.round(u),f,n,d),i.frame(Math.round(u),f,n,d)}i.text(c,u+(l<t.swatches.length?n+.6*o:0),h+.5*(r-1.164*o),{size:o,halo:!0,wrap:12*o,cut:!0})})}function so(i,t,e,o,a,r){const s=i.context,n=e.rect(t.panel),c=t.place==="top"||t.place==="bottom",l=c?n.width:n.height,u=c?n.height:n.width,h=a.info,f=Te(r,h.lo,h.hi)||1,d=Math.max(2,Math.round(.4*o));for(let M=0;M<n.height;M+=d)for(let E=0;E<n.width;E+=d){const k=(E/d+M/d)%2?219:255;I(s,[k,k,k,255],n.x+E,n.y+M,Math.min(d,n.width-E),Math.min(d,n.height-M))}let m=-1;const p=Math.max(1,Math.round(.08*o));for(let M=0;M<l;++M){const E=a.value(c?M/Math.max(1,l-1):1-M/Math.max(1,l-1)),k=et(r,E),S=Math.min(u-1,Math.max(0,Math.round(k/f*(u-1)))),K=[...Array.from(a.color(E)).slice(0,3).map(bo=>Math.round(255*Ft(bo))),255],X=Math.max(0,Math.min(S,m<0?S:m)-p+1),St=Math.max(S,m);c?(I(s,K,n.x+M,n.y+u-S,1,S),I(s,[26,26,31,255],n.x+M,n.y+u-1-St,1,St-X+1)):(I(s,K,n.x,n.y+M,S,1),I(s,[26,26,31,255],n.x+X,n.y+M,St-X+1,1)),m=S}i.frame(n.x,n.y,n.width,n.height);const[x,,g]=t.panel_texts,w=.78*o,v=i.measure("0",{size:w}).height,y=String(Number(f.toPrecision(2)));if(c){const M=n.x+n.width+.5*o;i.text(y,M,n.y-.15*v,{size:w,halo:!0}),i.text(x,M,n.y+n.height-.85*v,{size:w,halo:!0}),i.text(g,M,n.y+.5*(n.height-v),{size:w,halo:!0});return}const b=n.y+n.height+.25*o;i.text(x,n.x,b,{size:w,halo:!0}),i.text(y,n.x+n.width-i.measure(y,{size:w}).width,b,{size:w,halo:!0});const A=Math.min(n.width,i.measure(g,{size:w}).width);i.text(g,n.x+.5*(n.width-A),b+.95*v,{size:w,halo:!0})}function ro(i,t,e,o){const a=e.rect(t.glyph),r=a.y+.5*a.height,s=q(t.glyph_color),n=e.length(t.glyph[2]);if(t.glyph_arrow){const c=Math.min(.9*o,.4*n),l=.4*c,u=Math.max(.5,.12*c),h=a.x+n-c;i.polygon([[a.x,r-u],[h,r-u],[h,r-l],[a.x+n,r],[h,r+l],[h,r+u],[a.x,r+u]],s,!0)}else{const c=.5*Math.min(n,a.height);i.polygon(Array.from({length:32},(l,u)=>[a.x+c+c*Math.cos(u*.19634954),r+c*Math.sin(u*.19634954)]),s,!0)}i.text("= "+(t.glyph_text??""),a.x+n+.6*o,r-.58*o,{size:o,halo:!0})}const no='"DejaVu Sans", Verdana, "Bitstream Vera Sans", "Helvetica Neue", Arial, sans-serif',lo=.928,$t=1.164;class Ht{constructor(t,e,o=!1){this.context=t,this.quick=o,this.ink=e?"rgb(237 237 242)":"rgb(23 23 28)",this.rim=e?"rgb(13 13 18)":"rgb(255 255 255)"}lines(t,e){const o=this.context;o.font=`${e.bold?"bold ":""}${e.size}px ${no}`;const a=t.replaceAll("⁠","");if(!e.wrap||o.measureText(a.replaceAll("​","")).width<=e.wrap*1.002)return[a.replaceAll("​","")];if(e.cut){let n=a.length;for(;n>1&&o.measureText(a.slice(0,n)+"…").width>e.wrap;)--n;return[a.slice(0,n)+"…"]}const r=[];let s="";for(const n of a.split(/(?<=[ \u200b])/))s&&o.measureText((s+n).trimEnd().replaceAll("​","")).width>e.wrap*1.002&&(r.push(s),s=""),s+=n;return[...r,s].map(n=>n.replaceAll("​","").trimEnd())}measure(t,e){const o=this.lines(t,e);return{width:Math.max(...o.map(a=>this.context.measureText(a).width)),height:o.length*$t*e.size,lines:o.length}}text(t,e,o,a){const r=this.context,s=this.lines(t,a),n=Math.max(...s.map(c=>r.measureText(c).width));r.textBaseline="alphabetic",r.textAlign="left",r.lineJoin="round",s.forEach((c,l)=>{const u=e+(a.centred?.5*(n-r.measureText(c).width):0),h=o+(l*$t+lo)*a.size;a.halo&&!this.quick&&(r.strokeStyle=this.rim,r.lineWidth=.2*a.size,r.strokeText(c,u,h)),r.fillStyle=a.color??this.ink,r.fillText(c,u,h)})}turned(t,e,o,a,r){const s=this.context,n=this.measure(t,r);s.save(),s.translate(e,o),s.rotate(-a),this.text(t,-.5*n.width,-.5*n.height,r),s.restore()}line(t,e,o,a,r,s=this.ink,n=1){const c=this.context;c.globalAlpha=n,c.strokeStyle=s,c.lineWidth=r,c.lineCap="butt",c.beginPath(),c.moveTo(t,e),c.lineTo(o,a),c.stroke(),c.globalAlpha=1}polygon(t,e,o=!1){const a=this.context;a.beginPath(),t.forEach(([r,s],n)=>n?a.lineTo(r,s):a.moveTo(r,s)),a.closePath(),a.fillStyle=e,a.fill(),o&&(a.globalAlpha=.35,a.strokeStyle=this.ink,a.lineWidth=1,a.stroke(),a.globalAlpha=1)}frame(t,e,o,a){const r=this.context;r.globalAlpha=.35,r.strokeStyle=this.ink,r.lineWidth=1,r.strokeRect(t-.5,e-.5,o+1,a+1),r.globalAlpha=1}}class co{constructor(){this.canvas=document.createElement("canvas"),this.of=[],this.columns=[]}draw(t,e){const{annotation:o,layout:a}=e,r=t.getTransform(),s=[o,a,e.opacity,r.a];if(s.some((n,c)=>n!==this.of[c])){this.of=s,this.canvas.width=t.canvas.width,this.canvas.height=t.canvas.height;const n=this.canvas.getContext("2d"),c=new Ht(n,o.dark);n.setTransform(r),this.columns=o.legends.map(l=>oo(c,l,o,a,e.scales,e.opacity))}return t.setTransform(1,0,0,1,0,0),o.legends.length&&t.drawImage(this.canvas,0,0),t.setTransform(r),this.columns.map(n=>({...n}))}}function ho(i,t,e){const{annotation:o,layout:a,projection:r}=t,s=new Ht(i,o.dark,t.moving),n=o.font*a.factor,{area:c}=a,l=[];if(o.title){const h=o.title_size*a.factor,f=Math.max(1,a.width-1.6*n),d=s.measure(o.title,{size:h,wrap:f}),m={x:.5*(a.width-d.width),y:o.title_box[1]*a.factor,width:d.width,height:d.height};s.text(o.title,m.x,m.y,{size:h,wrap:f,centred:!0,halo:!0}),l.push(m)}for(const h of e.draw(i,t))l.push(j(h,.5*n));for(const h of l)h.x-=c.x,h.y-=c.y;i.save(),i.translate(c.x,c.y);const u=o.triad&&t.axes;if(o.letters&&go(s,r,n,l),u&&l.push(Vt(r.height,n)),o.caption){const h={size:n,wrap:Math.max(1,.55*r.width),centred:!0,halo:!0},f=s.measure(o.caption,h),d=o.caption_height>0,m={x:.5*(r.width-f.width),y:(d?a.height-c.y:r.height)-.6*n-f.height,width:f.width,height:f.height};s.text(o.caption,m.x,m.y,h),l.push(j(m,.3*n))}o.scale_bar&&t.box&&mo(s,o,r,t.box,n,l),fo(s,o,r,a,n,l),t.axes&&(uo(s,o,r,.88*n,l),t.box&&Je(s,o,t.box,r,n,l)),u&&to(s,o,r,n),i.restore()}function uo(i,t,e,o,a){for(const r of t.texts){const s=Y(e,r.at);if(!e.parallel&&!(s[2]>0))continue;const n=[_(r.along,e.right),_(r.along,e.up),_(r.along,e.forward)],c=(s[0]-.5*e.width)/e.scale,l=(.5*e.height-s[1])/e.scale,u=e.parallel?n[0]:n[0]-n[2]*c,h=e.parallel?n[1]:n[1]-n[2]*l;let f=u*u+h*h<1e-6*_(r.along,r.along)||!(_(r.along,r.along)>0)?0:Math.atan2(h,u);f>Math.PI/2+1e-9?f-=Math.PI:f<=-Math.PI/2+1e-9&&(f+=Math.PI);const d=o*r.size,m=i.measure(r.text,{size:d}),p=Math.max(1,Math.ceil(m.width/m.height)),x=[];for(let g=0;g<p;++g){const w=p>1?(g/(p-1)-.5)*(m.width-m.height):0;x.push({x:s[0]+w*Math.cos(f)-.5*m.height,y:s[1]-w*Math.sin(f)-.5*m.height,width:m.height,height:m.height})}x.some(g=>g.x<1||g.y<1||g.x+g.width>e.width-1||g.y+g.height>e.height-1||a.some(w=>$(w,g)))||(i.turned(r.text,s[0],s[1],f,{size:d,halo:!0,color:r.color?Ct(r.color):void 0}),a.push(...x))}}function fo(i,t,e,o,a,r){for(const s of t.notes){const n=a*s.size,c={size:n,wrap:Math.max(1,.9*o.width),halo:!0,color:s.color?Ct(s.color):void 0},l=i.measure(s.text,c),u=.6*a;let h=.5*(e.width-l.width),f=.5*(e.height-l.height);if(s.at)h=s.at[0]*o.width-o.area.x-.5*l.width,f=s.at[1]*o.height-o.area.y-.5*l.height;else{s.place.includes("left")&&(h=u),s.place.includes("right")&&(h=e.width-l.width-u),s.place.includes("top")&&(f=u),s.place.includes("bottom")&&(f=e.height-l.height-u);const d=s.place.includes("bottom")?-.5*a:.5*a;for(let m=0;m<100&&r.some(p=>$(p,{x:h,y:f,width:l.width,height:l.height}));++m)f+=d}i.text(s.text,h,f,c),r.push({x:h,y:f,width:l.width,height:l.height})}}function mo(i,t,e,o,a,r){const s=Y(e,[0,1,2].map(y=>.5*(o.lo[y]+o.hi[y]))),n=e.parallel?e.scale:e.scale/s[2];if(!(s[2]>0||e.parallel)||!(n>0))return;const c=.22*e.width/n,l=10**Math.floor(Math.log10(c)),u=(c/l>=5?5:c/l>=2?2:1)*l,h=u*n,f=`${Number(u.toPrecision(6))}${t.unit?" "+t.unit:""}`,d=i.measure(f,{size:a}),m=Math.max(2,.22*a),p=Math.max(d.width,h),x=d.height+.35*a+m,g={x:e.width-.9*a-p,y:e.height-.9*a-x,width:p,height:x},w=g.x+.5*(p-h),v=g.y+g.height-.5*m;i.line(w,v,w+h,v,m),i.text(f,g.x+.5*(p-d.width),g.y,{size:a,halo:!0}),r.push(j(g,.3*a))}function po(i){const t=[["R","L"],["A","P"],["I","S"]];return[0,1,2].filter(e=>Math.abs(i[e])>=.375).sort((e,o)=>Math.abs(i[o])-Math.abs(i[e])).map(e=>t[e][i[e]>0?1:0]).join("")}function go(i,t,e,o){const a=1.25*e,r=.6*e,s=n=>[-n[0],-n[1],-n[2]];for(const[n,c,l]of[[s(t.right),0,.5],[t.right,1,.5],[t.up,.5,0],[s(t.up),.5,1]]){const u=po(n),h=i.measure(u,{size:a,bold:!0}),f={x:r+c*(t.width-h.width-2*r),y:r+l*(t.height-h.height-2*r),width:h.width,height:h.height};o.some(d=>$(d,f))||(i.text(u,f.x,f.y,{size:a,bold:!0,halo:!0}),o.push(j(f,.5*e)))}}const Gt=2**-3.5,ft=2,xo=6,jt=28,wo=5,Xt=15,qt=180,vo=40;class Et{constructor(t,e,o,a,r){this.gl=t,this.canvas=e,this.over=o,this.scene=a,this.store=r,this.axes=!0,this.number=0,this.scales=[],this.frameTimes=[],this.onStep=null,this.onStill=null,this.legends=new co,this.behind=null,this.coarse=0,this.level=1,this.lastLevel=0,this.stride=ft,this.lastStart=0,this.lastDrawing=0,this.beside=jt-Xt,this.asked=0,this.rest=0,this.generation=0,this.ratio=1,this.moving=!1,this.still=!1,this.camera=new rt(a.camera),this.first=new rt(a.camera),this.composer=new fe(t,a),this.context=o.getContext("2d");const s=a.steps[0];this.center=Pt(Ot(s.items,s.annotation)),this.steps=a.steps.map(()=>{})}static async open(t,e,o,a,r){const s=new le(a.arrays,r),n=new Et(t,e,o,a,s);return n.scales=await xe(t,a.scales,s),await n.show(0),n}async show(t){const e=this.step?.volumes[0]?.points;this.number=t,this.steps[t]??=qe(this.gl,this.scene,t,this.center,this.scales,this.store);const o=await this.steps[t];this.number===t&&(this.step=o,e&&o.volumes[0]&&o.volumes[0].points!==e&&o.volumes[0].setOpacity(e),this.behind=o.annotation.box_behind&&o.box?new We(this.gl,o.box,this.center):null,await this.behind?.load(this.store),this.resize(),this.onStep?.())}resize(){const t=Math.max(1,this.canvas.clientWidth),e=Math.max(1,this.canvas.clientHeight);this.ratio=Math.min(2,window.devicePixelRatio||1);const o=Math.round(t*this.ratio),a=Math.round(e*this.ratio);(this.over.width!==o||this.over.height!==a)&&(this.over.width=o,this.over.height=a),this.layout=Ye(this.step.annotation,t,e),this.draw(this.step.volumes.length>0)}aspect(){return this.layout.area.width/this.layout.area.height}stated(){const[,,t,e]=this.step.annotation.area;return t/e}projection(t=1){const{area:e}=this.layout,o=Math.max(1,Math.round(e.width*t)),a=Math.max(1,Math.round(e.height*t));return this.camera.projection(o,a,Math.min(this.stated(),1.2),this.step.bounds)}draw(t){++this.generation,this.still=!1,this.moving=t||this.moving&&this.asked!==0,clearTimeout(this.rest),this.asked||(this.asked=requestAnimationFrame(()=>{this.asked=0,this.moving?(this.drawMoving(),this.rest=window.setTimeout(()=>{this.moving=!1,this.drawStill()},qt)):this.drawStill()}))}area(t){const{area:e,height:o}=this.layout;return{x:Math.round(e.x*t),y:Math.round((o-e.y-e.height)*t),width:Math.round(e.width*t),height:Math.round(e.height*t)}}pass(t,e){const o=this.projection(t*this.ratio),a={projection:o,center:this.center,samples:t*this.ratio,lamps:me(this.scene,o),peel:null,moving:e,soft:t===1&&!e},r=this.axes?this.behind?.at(o):null;return{pass:a,drawables:r?[...this.step.drawables,r]:this.step.drawables}}present(t){const e=this.ratio*Math.min(1,t),o=Math.max(1,Math.round(this.layout.width*e)),a=Math.max(1,Math.round(this.layout.height*e));(this.canvas.width!==o||this.canvas.height!==a)&&(this.canvas.width=o,this.canvas.height=a),this.composer.present(o,a,this.area(e),Math.max(1,t));const r=this.context;r.setTransform(this.ratio,0,0,this.ratio,0,0),r.clearRect(0,0,this.layout.width,this.layout.height),ho(r,{annotation:this.step.annotation,layout:this.layout,projection:this.projection(),box:this.step.box,scales:this.scales,opacity:this.step.volumes[0]?.points??null,axes:this.axes,moving:this.moving&&!this.still},this.legends)}drawingTime(){return Math.min(Xt,Math.max(wo,jt-this.beside))}drawMoving(){this.coarse===0&&(this.coarse=this.level=this.step.volumes.length?2**-2.5:1),(this.coarse>1.5*this.level||this.coarse<.9*this.level)&&(this.level=2**(Math.floor(2*Math.log2(this.coarse))/2));const t=performance.now(),e=t-this.lastStart,o=this.level,a=o===this.lastLevel,{pass:r,drawables:s}=this.pass(o,!0);this.composer.finish();const n=performance.now(),c=this.composer.layersOf(r,s,3);this.composer.draw(r,s,this.step.volumes,{samples:o,coarse:this.stride,layers:c}),this.composer.finish();const l=performance.now()-n;if(this.present(o),this.frameTimes.push(performance.now()-t),e<qt&&(this.beside+=.2*(e-this.lastDrawing-this.beside)),this.lastStart=t,this.lastDrawing=l,this.frameTimes.length>120&&this.frameTimes.shift(),this.lastLevel=o,!a)return;const u=this.drawingTime(),h=l/u,f=this.level*Math.min(2,Math.max(.25,1/Math.sqrt(h)));h>1.2&&this.level<=Gt*1.01&&this.step.volumes.length?this.stride=Math.min(xo,this.stride*Math.min(1.5,h)):h<.8&&this.stride>ft&&(this.stride=Math.max(ft,this.stride*Math.max(.8,h))),!(this.stride>ft)&&(this.coarse=Math.min(1,Math.max(Gt,this.coarse+(h>2?1:.3)*(f-this.coarse))))}stillQuality(){return{samples:this.step.drawables.some(e=>e.stage==="surface")?2:this.step.volumes.length?1:3,coarse:1,layers:12}}drawStill(){const t=this.stillQuality();this.step.volumes.length&&this.level<.5?this.drawFine({...t,samples:.5},()=>this.drawFine(t,()=>this.rested())):this.drawFine(t,()=>this.rested())}rested(){this.still=!0,this.onStill?.()}drawFine(t,e){const o=this.generation,{pass:a,drawables:r}=this.pass(t.samples,!1),s=a.projection.height,n=r.some(f=>f.translucent);t={...t,layers:this.composer.layersOf(a,r,t.layers)};const c=Math.ceil(s/(this.step.volumes.length?100:12));let l=0,u=this.step.volumes.length?Math.max(4,Math.round(s/40)):n?Math.ceil(s/8):s;const h=()=>{if(o!==this.generation)return;const f=performance.now(),d=Math.min(s,l+u);if(this.composer.draw(a,r,this.step.volumes,t,[l,d]),l=d,this.composer.finish(),l<s){u=Math.max(c,Math.round(u*Math.min(2,Math.max(.5,vo/(performance.now()-f))))),requestAnimationFrame(h);return}this.present(t.samples),e()};h()}setOpacity(t){for(const e of this.step.volumes)e.setOpacity(t);this.draw(!0)}snapshot(){const t=document.createElement("canvas"),e=t.getContext("2d");t.width=this.canvas.width,t.height=this.canvas.height;const o=this.stillQuality(),{pass:a,drawables:r}=this.pass(o.samples,!1);return this.still||this.composer.draw(a,r,this.step.volumes,{...o,layers:this.composer.layersOf(a,r,o.layers)}),this.present(o.samples),e.drawImage(this.canvas,0,0),e.drawImage(this.over,0,0),t}}const At=i=>document.getElementById(i)?.textContent??"";function dt(i){document.querySelector(".stage")?.remove(),document.body.append(T("p",{className:"sentence",textContent:i,role:"status"})),document.documentElement.dataset.state="picture"}async function yo(){document.head.append(T("style",{textContent:Wt}));const i=T("canvas",{}),t=T("canvas",{}),e=i.getContext("webgl2",{antialias:!1,alpha:!1,powerPreference:"high-performance"});if(!e)return dt("This browser has no WebGL2, or it is switched off: the picture does not turn here.");if(typeof DecompressionStream>"u")return dt("This browser is too old to unpack the scene: the picture does not turn here.");const o=JSON.parse(At("scene")),a=T("div",{className:"stage",tabIndex:0,role:"application",ariaLabel:document.title},i,t);document.body.append(a),document.body.classList.toggle("timed",o.steps.length>1);const r=await Et.open(e,i,t,o,l=>At(`a${l}`));i.addEventListener("webglcontextlost",()=>dt("The graphics card has given up this page: load it again."));const s=[];let n=null;if(r.step.volumes.length&&r.step.volumes[0].info.mode!=="sum"){n=new Zt(r);const l=n;s.push(N("opacity","The opacity of the volume (o)",()=>{l.panel.hidden=!l.panel.hidden}))}s.push(ae(o.notes,JSON.parse(At("recipe")||'""')));const c=oe(r,document.title,s);if(document.body.append(c.bar),n){const l=n;document.body.append(l.panel),c.keys.o=()=>{l.panel.hidden=!l.panel.hidden},r.onStep=()=>l.paint()}if(o.steps.length>1){const l=ee(r);document.body.append(l.bar),c.keys[" "]=l.play;const u=r.onStep;r.onStep=()=>{u?.(),l.tell()}}Yt(r,a,c.keys),new ResizeObserver(()=>r.resize()).observe(a),r.onStill=()=>{document.getElementById("poster")?.remove(),document.documentElement.dataset.state="still"},Object.assign(window,{sightglass:{viewer:r,editor:n}})}yo().catch(i=>dt(`The scene cannot be shown: ${i instanceof Error?i.message:String(i)}.`))})();
