# Un bagaglio con la sua foto: la pagina di una foto, e i bagagli negli elenchi.

photo-photo = Foto
photo-can-be-enlarged = Foto, si può ingrandire
photo-of = Foto del bagaglio #{ $id }
photo-of-newest = Foto { $take } di { $newest } del bagaglio #{ $id }, la più recente
photo-of-earlier = Foto { $take } di { $newest } del bagaglio #{ $id }, precedente
photo-found = Il bagaglio è stato trovato alla colonna { $column }, riga { $row }, il { $found }.
photo-decided = Il bagaglio è stato trovato alla colonna { $column }, riga { $row }, il { $found }; il verdetto è stato dato il { $decided } da { $who }.
photo-before = ← Bagaglio #{ $id }
photo-after = Bagaglio #{ $id } →
photo-every = Tutte le foto di questo bagaglio
photo-take = foto { $take }
photo-take-newest = foto { $take }, la più recente
photo-smaller = Più piccola
photo-whole = 1×: la foto intera
photo-larger = Più grande

## In un elenco

piece-no-photo = nessuna foto
piece-found = trovato: { $time }, in { $cell }
piece-decided = deciso: { $time }, da { $who }
piece-secured = messo al sicuro: { $time }

## Che cosa ne è stato deciso

