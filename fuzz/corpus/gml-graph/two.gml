Creator "us"
graph [
  directed 1
  node [ id 1 label "a &amp; b" graphics [ x 0.5 y 2 ] ]
  node [ id 7 label "c" ] # end
  edge [ source 1 target 7 weight 2.5 ]
]
